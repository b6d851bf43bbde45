"""Tables of named points: a row for each frame (wide), or one for each point in it (long)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.checks import drop_unsure
from mimoc.motion.frame_files import read_whole_file
from mimoc.motion.options import ReadOptions
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording
from mimoc.motion.read_mini_rgbd import RATE_HZ
from mimoc.motion.tables import COLUMNS, MOST_COLUMNS, Timing, label_and_column, numbers_of, read_cells, timing

SUFFIXES = ".csv", ".tsv"
_POINTS = "point", "bodypart", "keypoint", "name", "marker", "label", "joint"
_DEEPLABCUT = ["scorer", "bodyparts", "coords"]
"""First cells of its first three rows."""
MIN_SCORE = 0.3
"""That of COCO's formats, where a table does not say what wrote it."""
MIN_SCORES = {"likelihood": 0.6, "visibility": 0.5}
"""Those of DeepLabCut (default of `pcutoff` in its projects) and MediaPipe (from which on its `drawing_utils` draw), by
what they call confidence."""
_HEADERS = 4
"""Rows that may name columns."""

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
    header = ",".join(cell for row in rows[:_HEADERS] for cell in row).lower()
    usual = next((score for word, score in MIN_SCORES.items() if word in header), MIN_SCORE)
    return drop_unsure(_table(path, rows, options), options.least_score(usual))


def _table(path: Path, rows: Cells, options: ReadOptions) -> PointRecording:
    header = [cell.strip() for cell in rows[0]]
    lower = [cell.lower() for cell in header]
    if [row[0] for row in rows[:3]] == _DEEPLABCUT:
        of_points = [f"{point}_{column}" for point, column in zip(rows[1][1:], rows[2][1:], strict=True)]
        return _wide(path.stem, ["frame", *of_points], rows[3:])
    if rows[1][0] == "individuals":
        raise UnusableFileError("has several individuals; export the infant alone")
    if {"x", "y"} <= {*lower}:
        return _long(path.stem, lower, rows[1:])
    is_of_points = any(label_and_column(cell)[1] for cell in header)
    if len(header) > 1 and not is_of_points and all("," in cell for cell in rows[1][1:]):
        return _pairs(path.stem, header, rows[1:], options)
    return _wide(path.stem, header, rows[1:])


def _wide(name: str, header: Sequence[str], rows: Cells) -> PointRecording:
    columns: dict[str, dict[str, int]] = {}
    for index, cell in enumerate(header):
        label, what = label_and_column(cell)
        if what and what in columns.setdefault(label, {}):
            raise UnusableFileError(f"has the column {one_line(cell)} twice; keep one infant, and each column once")
        columns.setdefault(label, {})[what] = index
    labels = [label for label, indices in columns.items() if {"x", "y"} <= {*indices}]
    if not labels or not rows:
        shown = one_line(first_of(header, 5))
        raise UnusableFileError(f"has no points in columns such as neck_x and neck_y ({shown}); name its columns so")
    numbers = numbers_of(rows, header)
    unknown = np.full(len(numbers), np.nan)
    values = {
        what: np.stack([numbers[:, columns[label][what]] if what in columns[label] else unknown for label in labels], 1)
        for what in COLUMNS.values()
    }
    return _recording(name, labels, values, timing([cell.lower() for cell in header], numbers))


def _long(name: str, header: Sequence[str], rows: Cells) -> PointRecording:
    of_points = next((header.index(word) for word in _POINTS if word in header), None)
    of_frames = next((index for index, word in enumerate(header) if word.startswith("frame")), None)
    if of_points is None or of_frames is None:
        raise UnusableFileError("has x and y, but no columns 'frame' and 'point'; add them, or name columns neck_x ...")
    labels = list(dict.fromkeys(row[of_points] for row in rows))
    if len(labels) > MOST_COLUMNS:
        raise UnusableFileError(f"has {len(labels):,} points, which no body has; check the column '{_POINTS[0]}'")
    number_of = {label: index for index, label in enumerate(labels)}
    point = np.array([number_of[row[of_points]] for row in rows])
    numbers = numbers_of([[*row[:of_points], "", *row[of_points + 1 :]] for row in rows], header)
    _, first, frame = np.unique(numbers[:, of_frames], return_index=True, return_inverse=True)
    if len(np.unique(frame * len(labels) + point)) < len(rows):
        raise UnusableFileError("has a point twice in a frame; keep one infant only")
    values = {what: np.full((len(first), len(labels)), np.nan) for what in COLUMNS.values()}
    for index, cell in enumerate(header):
        if cell in COLUMNS and index != of_points:
            values[COLUMNS[cell]][frame, point] = numbers[:, index]
    return _recording(name, labels, values, timing(header, numbers[first]))


def _pairs(name: str, header: Sequence[str], rows: Cells, options: ReadOptions) -> PointRecording:
    """Return public keypoints of MINI-RGBD: after the name of a picture, a cell `x,y` for each joint."""
    try:
        cells = [[cell.split(",") if cell.strip() else ("nan", "nan") for cell in row[1:]] for row in rows]
        positions = np.array([[(float(x), float(y)) for x, y in row] for row in cells])
    except ValueError:
        raise UnusableFileError("has cells that are not 'x,y'; export it again") from None
    rate = [] if options.rate_hz else [f"{RATE_HZ:g} frames/s are taken for granted"]
    camera = [] if options.camera else ["the camera is taken for that of MINI-RGBD"]
    when = Timing(range(len(rows)), options.rate_hz or RATE_HZ, (*rate, *camera))
    recording = _recording(name, header[1:], {"x": positions[..., 0], "y": positions[..., 1]}, when)
    return replace(recording, camera=MINI_RGBD_CAMERA)


def _recording(name: str, labels: Sequence[str], values: Mapping[str, FloatArray], when: Timing) -> PointRecording:
    """Return the recording of columns, shape (n, k) each, that may be missing or NaN throughout."""
    known = {what: _placed(numbers, when.places) for what, numbers in values.items() if np.isfinite(numbers).any()}
    shape = when.places[-1] + 1, len(labels)
    unknown = np.full(shape, np.nan)
    axes = ("x", "y", "z") if "z" in known else ("x", "y")
    positions = np.stack([known.get(axis, unknown) for axis in axes], axis=-1)
    confidence = np.nan_to_num(known.get("confidence", np.ones(shape)), nan=0.0)
    seen = np.isfinite(positions).all(axis=-1) & (confidence > 0) & ~_empty(positions)
    return PointRecording(
        name,
        when.rate_hz,
        tuple(labels),
        np.where(seen[..., None], positions, np.nan),
        np.where(seen, confidence.clip(0, 1), 0.0),
        depth_m=known.get("depth_m") if len(axes) == 2 else None,
        notes=when.notes,
    )


def _empty(positions: FloatArray) -> npt.NDArray[np.bool_]:
    """Return where zeros stand for a point that is not seen, shape (t, k); one that is always there is the origin."""
    zero = np.asarray(~positions.any(axis=-1))
    return zero & ~(zero | np.isnan(positions).any(axis=-1)).all(axis=0)


def _placed(values: FloatArray, places: Sequence[int]) -> FloatArray:
    placed = np.full((places[-1] + 1, values.shape[1]), np.nan)
    placed[[*places]] = values
    return placed
