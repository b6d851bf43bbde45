"""Tables of text whose columns are numbers: their cells, and what the names of columns say."""

import csv
import math
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mimoc.base.errors import counted
from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.frame_files import MOST_FRAMES, frame_places
from mimoc.motion.point_recording import FloatArray

COLUMNS = {
    **{name: name for name in ("x", "y", "z", "confidence", "depth_m")},
    **{f"{axis}_{unit}": axis for axis in "xyz" for unit in ("px", "m")},
    **dict.fromkeys(("c", "conf", "score", "likelihood", "visibility", "probability", "p"), "confidence"),
    "depth": "depth_m",
}
"""What the name of a column, or its end, says that it holds."""
MOST_COLUMNS = 2000
_MOST_CELLS = 2**24
_TIMES = "time_s", "time", "t", "timestamp", "timestamp_s", "seconds"
_FRAMES = "frame", "frames", "frame_number", "frame_id", "frame_index"
_OF_POINT = re.compile(rf"(.+)[_. -]({'|'.join(sorted(COLUMNS, key=len, reverse=True))})", re.IGNORECASE)
_LARGEST_FRAME = 2**53
_RATE_DIGITS = 9
"""Digits of a frame rate that times of some digits can tell, after the point."""


class Timing(NamedTuple):
    """When the rows of a table were."""

    places: Sequence[int]
    """Index of each in time, from 0."""
    rate_hz: float
    """NaN if nothing says it."""
    notes: tuple[str, ...]


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

    Decimal commas are read, too.
    """
    try:
        return np.array([float(cell or "nan") for row in rows for cell in row]).reshape(len(rows), -1)
    except ValueError:
        return np.array([[_number(cell, name) for cell, name in zip(row, header, strict=True)] for row in rows])


def timing(header: Sequence[str], numbers: FloatArray) -> Timing:
    """Return when rows were, by columns of frame numbers or times; without any, one after the other.

    Args:
        header: Names of the columns, in lower case.
        numbers: Shape (n, c).
    """
    times_s, frames = (_column(header, numbers, names) for names in (_TIMES, _FRAMES))
    rate_hz = math.nan if times_s is None else _typical_rate(times_s)
    if frames is None:
        frames = np.arange(len(numbers)) if times_s is None else np.round((times_s - times_s[0]) * rate_hz)
    if not (np.abs(frames) < _LARGEST_FRAME).all() or (np.diff(frames) < 0).any():
        raise UnusableFileError("has frames without a number, or in no order; sort it by frames")
    if len(frames) > MOST_FRAMES:
        raise UnusableFileError(f"has {len(frames):,} frames; mimoc reads up to {MOST_FRAMES:,}: cut it")
    places, notes = frame_places([int(frame) for frame in frames], [f"row {row + 2}" for row in range(len(frames))])
    if times_s is not None and len(places) > 1:
        rate_hz = round(places[-1] / float(times_s[-1] - times_s[0]), _RATE_DIGITS)
    return Timing(places, rate_hz, notes)


def _number(cell: str, column: str) -> float:
    try:
        return float(cell.replace(",", ".")) if cell.strip() else math.nan
    except ValueError:
        if label_and_column(column)[1] or column in COLUMNS:
            wrong = f"'{one_line(cell):.30}' in the column {one_line(column)} is not a number"
            raise UnusableFileError(f"{wrong}; leave cells of unseen points empty") from None
        return math.nan


def _column(header: Sequence[str], numbers: FloatArray, names: Sequence[str]) -> FloatArray | None:
    return next((numbers[:, header.index(name)] for name in names if name in header), None)


def _typical_rate(times_s: FloatArray) -> float:
    steps_s = np.diff(times_s)
    if not len(steps_s):
        return math.nan
    if not (np.isfinite(times_s).all() and steps_s.min() > 0):
        raise UnusableFileError("has times that do not rise from row to row; check the column of times")
    return 1 / float(np.median(steps_s))
