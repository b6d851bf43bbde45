"""Landmarks of MediaPipe's pose: shares of the picture, pixels, or metres from the hips, in tables or JSON."""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion.checks import drop_unsure
from mimoc.motion.frame_files import MAX_FRAMES, first_bytes, parse, parse_frames, read_frame_files, read_whole_file
from mimoc.motion.point_recording import PointRecording, ReadOptions
from mimoc.motion.read_csv import MIN_SCORES, POINTS, SUFFIXES, label_and_column, points_in, points_of, read_cells
from mimoc.motion.sides import turned
from mimoc.motion.timing import FRAMES, is_of_times

_SIDES = "left", "right"
LANDMARKS = (
    "nose",
    *(f"{side}_eye{place}" for side in _SIDES for place in ("_inner", "", "_outer")),
    *(f"{side}_ear" for side in _SIDES),
    *(f"mouth_{side}" for side in _SIDES),
    *(f"{side}_{part}" for part in ("shoulder", "elbow", "wrist", "pinky", "index", "thumb") for side in _SIDES),
    *(f"{side}_{part}" for part in ("hip", "knee", "ankle", "heel", "foot_index") for side in _SIDES),
)
"""Names of the landmarks by number (MediaPipe's guide to its pose landmarker)."""
_OWN = {name for name in LANDMARKS if re.search("inner|outer|mouth|pinky|foot_index", name)}
"""Those that no other program has."""
_NAMES = {name.replace("_", ""): name for name in LANDMARKS}
_PREFIX = re.compile("(?:pose)?(?:world)?(?:landmarks?|lm|points?|keypoints?|kp)?")
_NUMBERED = re.compile("([xyzvp]|vis|visibility|presence)[_. -]?([0-9]{1,2})", re.IGNORECASE)
"""The name of a column such as `x0`: what it holds, and of which landmark."""
_SEEN = re.compile("(.+)[_. -](v|vis|presence)", re.IGNORECASE)
_VISIBILITY = {"v": "visibility", "vis": "visibility", "p": "presence"}
_FIRST_LINES = 100
_MAX_FROM_HIPS = 0.02
"""Distance of the middle of the hips from the origin, which is there, in the median over time, [m]."""
_RATES = "fps", "frame_rate", "framerate", "rate_hz"
_LISTS = "frames", "results", "data", "poses", "landmarks", "pose_landmarks", "pose_world_landmarks"
"""Where frames stand in a JSON file that is an object."""
_MAX_DIGITS = 19
_OTHERS = re.compile("face|hand|segment")  # In the names of landmarks that are not those of the pose.


def recognise(path: Path) -> bool:
    """Return whether it is a table, a JSON file or a folder of these with landmarks, by the first bytes."""
    suffix = ".json" if path.is_dir() else path.suffix.lower()
    if suffix not in (*SUFFIXES, ".json"):
        return False
    text = first_bytes(path).decode("utf-8-sig", "ignore")
    if suffix == ".json":
        has_landmarks = re.search('landmarks?"|"visibility"', text, re.IGNORECASE) or re.match(r"\s*\[\s*\[\s*\[", text)
        return bool(has_landmarks) and '"keypoints"' not in text
    lines = text.splitlines()[:_FIRST_LINES]
    try:
        rows = list(csv.reader(lines, delimiter=max(",;\t", key=(lines or [""])[0].count)))
    except csv.Error:
        return False
    return bool(rows) and _has_landmarks([cell.strip() for cell in rows[0]], rows[1:])


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return the landmarks in pixels or, with z upwards, in metres.

    Raises:
        UnusableFileError: If files are damaged, or have no landmarks.
    """
    if path.is_dir():
        recording = _of_folder(path, options)
    elif path.suffix.lower() == ".json":
        frames, rate_hz = _frames(parse(read_whole_file(path)))
        recording = _of_frames(path.stem, frames, rate_hz, options)
    else:
        recording = _of_table(path, read_whole_file(path), options)
    return drop_unsure(_placed(recording), options.least_score(MIN_SCORES["visibility"]))


def _placed(recording: PointRecording) -> PointRecording:
    if recording.unit == "px":
        return recording
    hips = [recording.path(name) for name in ("left_hip", "right_hip") if name in recording.names]
    middle = sum(hips, np.zeros((recording.frames, 3))) / 2
    middle = middle[np.isfinite(middle).all(axis=1)] if len(hips) > 1 else middle[:0]
    if not len(middle) or np.abs(np.median(middle, axis=0)).max() > _MAX_FROM_HIPS:
        note = "z is left out, which MediaPipe estimates"
        return replace(recording, positions=recording.positions[..., :2], notes=(*recording.notes, note))
    placed = turned(recording, "-z")
    placed.positions[..., 2] -= np.nanmin(placed.positions[..., 2])
    notes = (
        "its metres are MediaPipe's estimate from one camera, and are relative to the hips: where the infant is, and "
        "how it moves as a whole, is not known",
        "the camera is taken to look straight down",
    )
    return replace(placed, notes=(*recording.notes, *notes))


def _of_table(path: Path, content: bytes, options: ReadOptions) -> PointRecording:
    rows = read_cells(content)
    header = [cell.strip() for cell in rows[0]]
    column = _column_of_points(header)
    if column is None:
        return points_in(path.stem, [_columns(header), *rows[1:]], options)
    names = _names([row[column] for row in rows[1:]])
    named = [[*row[:column], name, *row[column + 1 :]] for row, name in zip(rows[1:], names, strict=True)]
    return points_in(path.stem, [header, *named], options)


def _has_landmarks(header: Sequence[str], rows: Sequence[Sequence[str]]) -> bool:
    """Return whether columns, or the points of rows, are landmarks by their names or by all numbers of them."""
    column = _column_of_points(header)
    if column is None:
        labels = [label for label, what, _ in map(_split, header) if what]
    else:
        labels = [row[column] for row in rows if len(row) > column]
    plain = {*map(_plain, labels)}
    return bool(_OWN & {_NAMES.get(word) for word in plain}) or any(
        {str(number) for number in range(first, first + len(LANDMARKS))} == {word.lstrip("0") or "0" for word in plain}
        for first in (0, 1)
    )


def _column_of_points(header: Sequence[str]) -> int | None:
    lower = [cell.lower() for cell in header]
    return next((lower.index(word) for word in POINTS if word in lower and "x" in lower), None)


def _columns(header: Sequence[str]) -> list[str]:
    parts = [_split(cell) for cell in header]
    names = iter(_names([label for label, what, _ in parts if what]))
    is_seen = any(what in ("visibility", "confidence") for _, what, _ in parts)
    ends = [end if is_seen or what != "presence" else "_visibility" for _, what, end in parts]
    return [f"{next(names)}{end}" if what else label for (label, what, _), end in zip(parts, ends, strict=True)]


def _split(cell: str) -> tuple[str, str, str]:
    """Return the label of a column, what it holds of it, if anything, and how its name then ends."""
    if match := _NUMBERED.fullmatch(cell):
        what = _VISIBILITY.get(match[1].lower(), match[1].lower())
        return match[2], what, f"_{what}"
    if match := _SEEN.fullmatch(cell):
        what = _VISIBILITY.get(match[2].lower(), match[2].lower())
        return match[1], what, f"_{what}"
    label, what = label_and_column(cell)
    return label, what, cell[len(label) :]


def _names(labels: Sequence[str]) -> list[str]:
    plain = [_plain(label) for label in labels]
    numbers = {int(word) for word in plain if word.isdecimal() and len(word) <= len(str(len(LANDMARKS)))}
    first = 1 if len(LANDMARKS) in numbers and 0 not in numbers else 0
    by_word = {str(number): name for number, name in enumerate(LANDMARKS, first)} | _NAMES
    return [by_word.get(word.lstrip("0") or "0", label) for word, label in zip(plain, labels, strict=True)]


def _plain(label: str) -> str:
    word = re.sub("[^a-z0-9]", "", re.split("[.:]", label)[-1].lower())
    return word[match.end() :] if (match := _PREFIX.match(word)) else word


def _of_folder(path: Path, options: ReadOptions) -> PointRecording:
    files = read_frame_files(path, ".json")
    frames: list[Any] = [None] * files.frames
    for place, _, data in parse_frames(files):
        frames[place] = data
    recording = _of_frames(path.name, frames, math.nan, options)
    return replace(recording, notes=(*files.notes, *recording.notes))


def _of_frames(name: str, frames: Sequence[Any], rate_hz: float, options: ReadOptions) -> PointRecording:
    header = [f"{landmark}_{what}" for landmark in LANDMARKS for what in ("x", "y", "z", "visibility")]
    numbers = np.full((len(frames), len(LANDMARKS), 4), np.nan)
    for index, frame in enumerate(frames):
        try:
            which, points = _points(frame, prefer_world=options.picture_px is None)
            if points:
                numbers[index, which] = [_four(point) for point in points]
        except (TypeError, ValueError, KeyError, IndexError, OverflowError, AttributeError):
            raise UnusableFileError(f"frame {index} of the list: landmarks are damaged; export it again") from None
    columns = [
        key
        for key in (frames[0] if frames and isinstance(frames[0], dict) else ())
        if key.lower() in FRAMES or is_of_times(key.lower())
    ]
    known = [key for key in columns if all(isinstance(frame, dict) and _is_finite(frame.get(key)) for frame in frames)]
    when = np.array([[frame[key] for key in known] for frame in frames], dtype=np.float64).reshape(len(frames), -1)
    recording = points_of(name, [*known, *header], np.concatenate([when, numbers.reshape(len(frames), -1)], axis=1))
    return recording if math.isfinite(recording.rate_hz) else replace(recording, rate_hz=rate_hz)


def _frames(data: Any) -> tuple[Sequence[Any], float]:
    rate_hz = math.nan
    if isinstance(data, dict):
        rate_hz = next((float(data[key]) for key in _RATES if _is_finite(data.get(key))), math.nan)
        if data and all(key.isdecimal() and len(key) <= _MAX_DIGITS for key in data):
            data = [data[key] for key in sorted(data, key=int)]
        else:
            data = next((data[key] for key in _LISTS if isinstance(data.get(key), list)), None)
    if not isinstance(data, list) or not data:
        raise UnusableFileError("has no list of frames with landmarks; export it again, or give another format")
    if isinstance(data[0], dict) and "x" in data[0]:
        data = [data]
    if len(data) > MAX_FRAMES:
        raise UnusableFileError(f"has {len(data):,} frames; mimoc reads up to {MAX_FRAMES:,}: cut it")
    return data, rate_hz


def _points(frame: Any, *, prefer_world: bool) -> tuple[Sequence[int], Sequence[Any]]:
    points = frame
    if isinstance(frame, dict):
        keys = [key for key in frame if "landmark" in key.lower() and not _OTHERS.search(key.lower())]
        keys.sort(key=lambda key: ("world" in key.lower()) != prefer_world)
        named = {key: value for key, value in frame.items() if _plain(key) in _NAMES}
        points = next((frame[key] for key in keys if frame[key]), named)
        if isinstance(points, dict) and "landmark" in points:  # As protocol buffers become JSON.
            points = points["landmark"]
    first = points[0] if isinstance(points, list) and points else None
    if isinstance(first, list) and first and isinstance(first[0], (dict, list)):
        if len(points) > 1:
            raise UnusableFileError("has several persons in a frame; export the infant alone")
        points = points[0]
    if not points:
        return (), ()
    if isinstance(points, dict):
        return [LANDMARKS.index(name) for name in _names([*points])], [*points.values()]
    keys = [key for key in ("name", "id", "index", "landmark") if isinstance(points[0], dict) and key in points[0]]
    if keys:
        return [LANDMARKS.index(name) for name in _names([str(point[keys[0]]) for point in points])], points
    if len(points) != len(LANDMARKS):
        raise UnusableFileError(f"has {len(points)} landmarks in a frame, and not {len(LANDMARKS)}; export it again")
    return range(len(points)), points


def _four(point: Any) -> tuple[Any, ...]:
    if isinstance(point, dict):
        seen = point["visibility"] if "visibility" in point else point.get("presence", 1.0)
        return point["x"], point["y"], point.get("z"), seen
    return (*point, None, 1.0)[:4] if len(point) == 2 else (*point, 1.0)[:4]


def _is_finite(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300
