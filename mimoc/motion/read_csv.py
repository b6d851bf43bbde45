"""Tables of named points: a row for each frame (wide), or one for each point in it (long)."""

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mimoc.base.errors import counted, suggestion
from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.checks import are_shares, drop_unsure
from mimoc.motion.frame_files import numbers_of_files, read_whole_file
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording, ReadOptions
from mimoc.motion.read_mini_rgbd import RATE_HZ
from mimoc.motion.timing import FRAMES, Timing, is_of_times, on_frames, timing

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""By unit of places in space, with which the name of a column may end: `neck_x_mm`."""
COLUMNS = {
    **{name: name for name in ("x", "y", "z", "confidence", "depth_m")},
    **{f"{axis}_{unit}": axis for axis in "xyz" for unit in ("px", *METRES)},
    **dict.fromkeys(("c", "conf", "score", "likelihood", "visibility", "probability", "p"), "confidence"),
    "depth": "depth_m",
}
"""What the name of a column, or its end, says that it holds."""
MAX_COLUMNS = 2000
_MAX_CELLS = 2**24
_CLOCK = re.compile(r"(?:.*[ T])?(?:([0-9]{1,2}):)?([0-9]{1,2}):([0-9]{1,2}(?:[.,][0-9]+)?)")
_SIXTY = 3600, 60, 1  # A time of day or since the beginning, as in `00:01:59.033`, and the seconds of its parts.
_OF_AXIS = re.compile(rf"(?:.+[_. -])?[xy]_(px|{'|'.join(METRES)})", re.IGNORECASE)
_OF_POINT = re.compile(rf"(.+)[_. -]({'|'.join(sorted(COLUMNS, key=len, reverse=True))})", re.IGNORECASE)


def read_cells(content: bytes) -> list[list[str]]:
    """Return the cells of a table, of which every row has as many as the first.

    Columns are separated by commas or, where the first row has more of these, by semicolons or tabs.
    """
    try:
        text = content.decode("utf-8-sig")
        first = text.partition("\n")[0]
        if sum(map(text.count, ",;\t\n")) > _MAX_CELLS:
            raise UnusableFileError(f"has more than {_MAX_CELLS:,} cells, which no recording has; cut it")
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
    if width > MAX_COLUMNS:
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


SUFFIXES = ".csv", ".tsv"
POINTS = (
    *("point", "bodypart", "keypoint", "name", "marker", "label", "joint"),
    *("landmark", "landmark_name", "landmark_id", "landmark_index"),
)
"""Columns with the name of a point, of tables with a row for each."""
_IMAGES = "image", "image_name", "image_id", "img", "file", "file_name", "filename"
"""Columns whose text has the number of a frame in it."""
_PERSONS = "track", "track_id", "individual", "individuals", "person", "person_id", "subject", "animal"
_DEEPLABCUT = "scorer", "individuals", "bodyparts", "coords"
"""First cells of its first rows; the second is not in tables of one individual."""
_NO_INDIVIDUAL = "single"  # What DeepLabCut calls the points that belong to no individual.
_BRACKETS = re.compile(r"[ _]*[(\[]\s*(px|m|cm|mm)\s*[)\]]$", re.IGNORECASE)
"""A unit at the end of a column's name, such as that of `left_hip_x [mm]`."""
_MAX_NAMED = 8
MIN_SCORE = 0.3  # That of COCO's formats, where a table does not say what wrote it.
MIN_SCORES = {"likelihood": 0.6, "visibility": 0.5}
"""Those of DeepLabCut (default of `pcutoff` in its projects) and MediaPipe (from which on its `drawing_utils` draw), by
what they call confidence."""
_HEADERS = 4

Cells = Sequence[Sequence[str]]


def recognise(path: Path) -> bool:
    """Return whether its name ends in `.csv` or `.tsv`."""
    return path.suffix.lower() in SUFFIXES and not path.is_dir()


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return the points of a table; the frame rate is that of its times, if it has a column of them.

    Raises:
        UnusableFileError: If it is not a table of points, or damaged.
    """
    rows = read_cells(read_whole_file(path))
    recording = _flat(points_in(path.stem, rows, options), unit_of(_titles(rows)), options)
    header = ",".join(cell for row in rows[:_HEADERS] for cell in row).lower()
    usual = next((score for word, score in MIN_SCORES.items() if word in header), MIN_SCORE)
    return drop_unsure(recording, options.least_score(usual))


def points_in(name: str, rows: Cells, options: ReadOptions) -> PointRecording:
    """Return the points of a table of *rows*, in the unit of its columns, if any, or raise an UnusableFileError."""
    header = _titles(rows)
    if rows[0][0].strip().lower() == _DEEPLABCUT[0]:
        return _of_deeplabcut(name, rows, options)
    lower = [cell.lower() for cell in header]
    if {"x", "y"} <= {COLUMNS.get(cell) for cell in lower}:
        return _long(name, lower, _of_one_person(lower, rows[1:], options))
    is_of_points = any(label_and_column(cell)[1] for cell in header)
    if len(header) > 1 and not is_of_points and all("," in cell for cell in rows[1][1:]):
        return _pairs(name, header, rows[1:], options)
    return _wide(name, header, _of_one_person(lower, rows[1:], options))


def points_of(name: str, header: Sequence[str], numbers: FloatArray) -> PointRecording:
    """Return the points of a table with a row for each frame, whose cells are numbers, shape (n, c)."""
    columns: dict[str, dict[str, int]] = {}
    for index, cell in enumerate(header):
        label, what = label_and_column(cell)
        if what and what in columns.setdefault(label, {}):
            raise UnusableFileError(f"has the column {one_line(cell)} twice; keep one infant, and each column once")
        columns.setdefault(label, {})[what] = index
    labels = [label for label, indices in columns.items() if {"x", "y"} <= {*indices}]
    if not labels or not len(numbers):
        shown = one_line(first_of(header, 5))
        raise UnusableFileError(f"has no points in columns such as neck_x and neck_y ({shown}); name its columns so")
    unknown = np.full(len(numbers), np.nan)
    values = {
        what: np.stack([numbers[:, columns[label][what]] if what in columns[label] else unknown for label in labels], 1)
        for what in COLUMNS.values()
    }
    return _recording(name, labels, values, timing([cell.lower() for cell in header], numbers), unit_of(header))


def _titles(rows: Cells) -> list[str]:
    """Return the names of columns, in which units in brackets are as others write them, `left_hip_x_mm`."""
    return [_BRACKETS.sub(r"_\1", cell.strip()) for cell in rows[0]]


def _flat(recording: PointRecording, unit: str, options: ReadOptions) -> PointRecording:
    """Return a recording without its third axis if the other two are shares of a picture."""
    if recording.unit == "px" or unit in METRES or not are_shares(recording.positions):
        return recording
    if options.picture_px is None:
        raise UnusableFileError(
            "has x and y from 0 to 1: name columns of metres neck_x_m; give the size of the picture, "
            "picture_px=(1920, 1080); or export pixels, not shares of the picture"
        )
    notes = *recording.notes, "z is left out: x and y are shares of the picture"
    return replace(recording, positions=recording.positions[..., :2], notes=notes)


def _wide(name: str, header: Sequence[str], rows: Cells) -> PointRecording:
    header, rows = _numbered(header, rows)
    return points_of(name, header, numbers_of(rows, header))


def _long(name: str, header: Sequence[str], rows: Cells) -> PointRecording:
    header, rows = _numbered(header, rows)
    of_points = next((header.index(word) for word in POINTS if word in header), None)
    of_frames = next(
        (index for index, word in enumerate(header) if word.startswith("frame") or is_of_times(word)), None
    )
    if of_points is None or of_frames is None:
        raise UnusableFileError("has x and y, but no columns 'frame' and 'point'; add them, or name columns neck_x ...")
    labels = list(dict.fromkeys(row[of_points] for row in rows))
    if len(labels) > MAX_COLUMNS:
        raise UnusableFileError(f"has {len(labels):,} points, which no body has; check the column '{POINTS[0]}'")
    number_of = {label: index for index, label in enumerate(labels)}
    point = np.array([number_of[row[of_points]] for row in rows], dtype=np.intp)
    numbers = numbers_of([[*row[:of_points], "", *row[of_points + 1 :]] for row in rows], header)
    _, first, frame = np.unique(numbers[:, of_frames], return_index=True, return_inverse=True)
    if len(np.unique(frame * len(labels) + point)) < len(rows):
        raise UnusableFileError("has a point twice in a frame; keep one infant only")
    values = {what: np.full((len(first), len(labels)), np.nan) for what in COLUMNS.values()}
    for index, cell in enumerate(header):
        if cell in COLUMNS and index != of_points:
            values[COLUMNS[cell]][frame, point] = numbers[:, index]
    return _recording(name, labels, values, timing(header, numbers[first]), unit_of(header))


def _of_deeplabcut(name: str, rows: Cells, options: ReadOptions) -> PointRecording:
    """Return the points of one individual; before the columns of points may be some with the names of pictures."""
    cells = [[cell.strip() for cell in row] for row in rows[: len(_DEEPLABCUT)]]
    titles = {row[0].lower(): row for row in cells}
    if not {*_DEEPLABCUT[-2:]} <= titles.keys():
        raise UnusableFileError("has a row 'scorer', but no rows 'bodyparts' and 'coords' below it; export it again")
    parts, axes = (titles[title] for title in _DEEPLABCUT[-2:])
    individuals = titles.get(_DEEPLABCUT[1], [""] * len(parts))
    columns = [index for index, axis in enumerate(axes) if index and axis.lower() in COLUMNS]
    infant = _infant([individuals[index] for index in columns], options)
    chosen = [index for index in columns if individuals[index] == infant]
    header = ["frame", *(f"{parts[index]}_{axes[index]}" for index in chosen)]
    frame = columns[0] - 1 if columns else 0
    below = rows[1 + [*titles].index(_DEEPLABCUT[-1]) :]
    return _wide(name, header, [[row[frame], *(row[index] for index in chosen)] for row in below])


def _of_one_person(header: Sequence[str], rows: Cells, options: ReadOptions) -> Cells:
    """Return the rows of the infant, in a table with a column that says whose they are."""
    column = next((header.index(word) for word in _PERSONS if word in header), None)
    if column is None:
        return rows
    infant = _infant([row[column].strip() for row in rows], options)
    return [row for row in rows if row[column].strip() == infant]


def _infant(names: Sequence[str], options: ReadOptions) -> str:
    known = [*dict.fromkeys(names)]
    known = [name for name in known if name not in ("", _NO_INDIVIDUAL)] or known
    asked = None if options.infant is None else str(options.infant)
    if asked in known:
        return str(asked)
    if asked is not None and not (asked == "0" and len(known) == 1):
        near = suggestion(one_line(asked), [one_line(name) for name in known])
        raise UnusableFileError(f"has no individual '{one_line(asked)}'; {near}")
    if len(known) > 1:
        shown = one_line(first_of(known, _MAX_NAMED))
        raise UnusableFileError(
            f"has several individuals ({shown}); say which is the infant: infant='{one_line(known[0])}'"
        )
    return known[0] if known else ""


def _numbered(header: Sequence[str], rows: Cells) -> tuple[Sequence[str], Cells]:
    """Return a table in which names of pictures, by which its rows are numbered, are the numbers of frames."""
    lower = [cell.lower() for cell in header]
    names = FRAMES if any(map(is_of_times, lower)) else (*FRAMES, *_IMAGES)
    column = next((lower.index(word) for word in names if word in lower), None)
    if column is None or all(map(_is_number, texts := [row[column] for row in rows])):
        return header, rows
    different = [*dict.fromkeys(texts)]
    numbers = dict(zip(different, numbers_of_files(different) or (), strict=False))
    if not numbers:
        raise UnusableFileError(f"has no numbers of frames in the column {one_line(header[column])}; number its frames")
    numbered = [[*row[:column], str(numbers[text]), *row[column + 1 :]] for row, text in zip(rows, texts, strict=True)]
    return [*header[:column], FRAMES[0], *header[column + 1 :]], numbered


def _is_number(cell: str) -> bool:
    try:
        float(cell or "nan")
    except ValueError:
        return False
    return True


def _pairs(name: str, header: Sequence[str], rows: Cells, options: ReadOptions) -> PointRecording:
    """Return public keypoints of MINI-RGBD: after the name of a picture, a cell `x,y` for each joint."""
    try:
        cells = [[cell.split(",") if cell.strip() else ("nan", "nan") for cell in row[1:]] for row in rows]
        positions = np.array([[(float(x), float(y)) for x, y in row] for row in cells])
    except ValueError:
        raise UnusableFileError("has cells that are not 'x,y'; export it again") from None
    rate = [] if options.rate_hz else [f"{RATE_HZ:g} frames/s are taken for granted"]
    camera = [] if options.camera else ["the camera is taken for that of MINI-RGBD"]
    frames = np.arange(len(positions))
    when = Timing(frames, frames.astype(np.float64), options.rate_hz or RATE_HZ, (*rate, *camera))
    recording = _recording(name, header[1:], {"x": positions[..., 0], "y": positions[..., 1]}, when)
    return replace(recording, camera=MINI_RGBD_CAMERA)


def _recording(
    name: str, labels: Sequence[str], values: Mapping[str, FloatArray], when: Timing, unit: str = ""
) -> PointRecording:
    """Return the recording of columns, shape (n, k) each, that may be missing or NaN throughout."""
    known = {what: numbers[when.rows] for what, numbers in values.items() if np.isfinite(numbers).any()}
    shape = len(when.rows), len(labels)
    axes = ("x", "y", "z") if "z" in known and unit != "px" else ("x", "y")
    positions = np.stack([known.get(axis, np.full(shape, np.nan)) for axis in axes], axis=-1) * METRES.get(unit, 1.0)
    confidence = np.nan_to_num(known.get("confidence", np.ones(shape)), nan=0.0).clip(0, 1)
    # Zeros stand for a point that is not seen; one that is always there is the origin.
    zero = np.asarray(~positions.any(axis=-1))
    seen = (
        np.isfinite(positions).all(axis=-1)
        & (confidence > 0)
        & ~(zero & ~(zero | np.isnan(positions).any(axis=-1)).all(axis=0))
    )
    depth_m = known.get("depth_m") if len(axes) == 2 else None
    return PointRecording(
        name,
        when.rate_hz,
        tuple(labels),
        on_frames(np.where(seen[..., None], positions, np.nan), when.places),
        np.nan_to_num(on_frames(np.where(seen, confidence, 0.0), when.places, least=True)),
        depth_m=None if depth_m is None else on_frames(depth_m, when.places),
        notes=when.notes,
    )
