"""Tables of text whose columns are numbers: their cells, and what the names of columns say."""

import csv
import math
import re
from collections.abc import Sequence

import numpy as np

from mimoc.base.errors import counted
from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.point_recording import FloatArray

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""By unit of places in space, with which the name of a column may end: `neck_x_mm`."""
COLUMNS = {
    **{name: name for name in ("x", "y", "z", "confidence", "depth_m")},
    **{f"{axis}_{unit}": axis for axis in "xyz" for unit in ("px", *METRES)},
    **dict.fromkeys(("c", "conf", "score", "likelihood", "visibility", "probability", "p"), "confidence"),
    "depth": "depth_m",
}
"""What the name of a column, or its end, says that it holds."""
MOST_COLUMNS = 2000
_MOST_CELLS = 2**24
_CLOCK = re.compile(r"(?:.*[ T])?(?:([0-9]{1,2}):)?([0-9]{1,2}):([0-9]{1,2}(?:[.,][0-9]+)?)")
_SIXTY = 3600, 60, 1
"""A time of day or since the beginning, as in `00:01:59.033`, and the seconds of its parts."""
_OF_AXIS = re.compile(rf"(?:.+[_. -])?[xy]_(px|{'|'.join(METRES)})", re.IGNORECASE)
_OF_POINT = re.compile(rf"(.+)[_. -]({'|'.join(sorted(COLUMNS, key=len, reverse=True))})", re.IGNORECASE)


def read_cells(content: bytes) -> list[list[str]]:
    """Return the cells of a table, of which every row has as many as the first.

    Columns are separated by commas or, where the first row has more of these, by semicolons or tabs.
    """
    try:
        text = content.decode("utf-8-sig")
        first = text.partition("\n")[0]
        if sum(map(text.count, ",;\t\n")) > _MOST_CELLS:
            raise UnusableFileError(f"has more than {_MOST_CELLS:,} cells, which no recording has; cut it")
        rows = [row for row in csv.reader(text.splitlines(), delimiter=max(",;\t", key=first.count)) if row]
    except (UnicodeDecodeError, csv.Error):
        raise UnusableFileError("is not a table of text; save it as CSV (UTF-8)") from None
    if len(rows) < 2:
        raise UnusableFileError("has no rows below its first line, which names the columns; check what was exported")
    width = len(rows[0])
    wrong = next((index for index, row in enumerate(rows) if len(row) != width), None)
    if wrong is not None:
        cells = counted(len(rows[wrong]), "cell")
        raise UnusableFileError(f"row {wrong + 1} has {cells}, not {width} as the first; export it again")
    if width > MOST_COLUMNS:
        raise UnusableFileError(f"has {width:,} columns, which no recording has; cut it")
    return rows


def label_and_column(cell: str) -> tuple[str, str]:
    """Return the label of a point and what a column holds of it: of `left_hip_x_px`, `left_hip` and `x`."""
    match = _OF_POINT.fullmatch(cell)
    return (match[1], COLUMNS[match[2].lower()]) if match else (cell, "")


def numbers_of(rows: Sequence[Sequence[str]], header: Sequence[str]) -> FloatArray:
    """Return cells as numbers, shape (n, c); an empty one, and text in a column of anything else, is NaN.

    Decimal commas are read, too, and times such as `00:01:59.033`, in seconds.
    """
    try:
        return np.array([float(cell or "nan") for row in rows for cell in row]).reshape(len(rows), -1)
    except ValueError:
        return np.array([[_number(cell, name) for cell, name in zip(row, header, strict=True)] for row in rows])


def unit_of(header: Sequence[str]) -> str:
    """Return the unit of x and y by names such as `neck_x_mm`, "" for none; UnusableFileError for several."""
    units = sorted({match[1].lower() for cell in header if (match := _OF_AXIS.fullmatch(cell))})
    if len(units) > 1:
        raise UnusableFileError(f"has columns in {' and '.join(units)}; export all in one unit")
    return units[0] if units else ""


def _number(cell: str, column: str) -> float:
    try:
        return float(cell.replace(",", ".")) if cell.strip() else math.nan
    except ValueError:
        if label_and_column(column)[1] or column in COLUMNS:
            wrong = f"'{one_line(cell):.30}' in the column {one_line(column)} is not a number"
            raise UnusableFileError(f"{wrong}; leave cells of unseen points empty") from None
        clock = _CLOCK.fullmatch(cell.strip())
        parts = [float((part or "0").replace(",", ".")) for part in clock.groups()] if clock else []
        return sum(part * size for part, size in zip(parts, _SIXTY, strict=True)) if parts else math.nan
