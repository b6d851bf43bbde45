"""COCO keypoints: results, annotations and what MMPose and AlphaPose write, a file for each frame or one for all."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from mimoc.base.errors import counted
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion.checks import drop_unsure
from mimoc.motion.frame_files import first_bytes, frame_places, read_frame_files, read_whole_file
from mimoc.motion.json_frames import objects, parse, parse_frames
from mimoc.motion.options import ReadOptions
from mimoc.motion.persons import Frame, Person, identity, person, place_points
from mimoc.motion.point_recording import PointRecording

COCO_17 = (
    "nose",
    *(f"{side}_{part}" for part in ("eye", "ear", "shoulder", "elbow", "wrist") for side in ("left", "right")),
    *(f"{side}_{part}" for part in ("hip", "knee", "ankle") for side in ("left", "right")),
)
"""Order of the points (COCO's documentation of its keypoints)."""
_FEET = (
    *(f"left_{part}" for part in ("big_toe", "small_toe", "heel")),
    *(f"right_{part}" for part in ("big_toe", "small_toe", "heel")),
)
_HALPE = (
    "crown",
    "neck",
    "mid_hip",
    *(f"{side}_{part}" for part in ("big_toe", "small_toe", "heel") for side in ("left", "right")),
)
LAYOUTS = {
    17: COCO_17,
    23: (*COCO_17, *_FEET),
    26: (*COCO_17, *_HALPE),
    133: (*COCO_17, *_FEET, *(f"whole_body_{number}" for number in range(23, 133))),
}
"""Labels by number of points: COCO, with feet, Halpe, and COCO-WholeBody."""
MIN_SCORE = 0.3
"""MMPose draws points from this on (default of its `kpt_thr`)."""
_IDENTITIES = "track_id", "idx", "person_id", "instance_id"
_FRAMES = "image_id", "frame_id", "frame"


def recognise(path: Path) -> bool:
    """Return whether it is a JSON file, or a folder whose first JSON file has keypoints."""
    return b'"keypoints"' in first_bytes(path) if path.is_dir() else path.suffix.lower() == ".json"


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return the points of the infant; they have no frame rate.

    Raises:
        UnusableFileError: If files are damaged, or it is not clear who the infant is.
    """
    labels, frames, notes = _from_folder(path) if path.is_dir() else _from_file(path)
    width = next((len(infant.numbers) for frame in frames for infant in frame.persons), 0)
    labels = labels if len(labels) == width / 3 else LAYOUTS.get(width // 3, ())
    if not labels or width % 3:
        known = ", ".join(map(str, LAYOUTS))
        raise UnusableFileError(f"has {counted(width, 'number')} a person; mimoc knows {known} points of 3 numbers")
    least = options.least_score(MIN_SCORE)
    positions, confidence, more = place_points(frames, options, len(labels), least)
    recording = PointRecording(path.stem, math.nan, labels, positions, confidence, notes=(*notes, *more))
    return drop_unsure(recording, least)


def _from_folder(path: Path) -> tuple[tuple[str, ...], list[Frame], tuple[str, ...]]:
    files = read_frame_files(path, ".json")
    frames = [Frame(place, name, _persons(_items(data, name), name)) for place, name, data in parse_frames(files)]
    return (), frames, files.notes


def _from_file(path: Path) -> tuple[tuple[str, ...], list[Frame], tuple[str, ...]]:
    data = parse(read_whole_file(path))
    by_frame = _by_frame(data, path.name)
    if not by_frame:
        raise UnusableFileError("has no frames; check what the pose estimator was given")
    names = [f"frame {number}" for number, _ in by_frame]
    places, notes = frame_places([number for number, _ in by_frame], names)
    persons = [_persons(items, name) for (_, items), name in zip(by_frame, names, strict=True)]
    return _labels(data), [Frame(*frame) for frame in zip(places, names, persons, strict=True)], notes


def _by_frame(data: Any, where: str) -> list[tuple[int, Sequence[Mapping[str, Any]]]]:
    """Return the entries of persons, in the order of the numbers of their frames."""
    frames = objects(data, where, "instance_info") if _has(data, "instance_info") else data
    if isinstance(frames, list) and frames and all(_has(frame, "instances") for frame in frames):
        numbered = [(_frame_number(frame, where), objects(frame, where, "instances")) for frame in frames]
        return sorted(numbered, key=lambda frame: frame[0])
    entries = _items(data, where)
    images = _image_numbers(data)
    ids = [str(entry.get("image_id")) for entry in entries]
    is_known = bool(images) and {*ids} <= images.keys()
    numbers = [images[name] for name in ids] if is_known else [_frame_number(entry, where) for entry in entries]
    order = sorted(range(len(entries)), key=numbers.__getitem__)
    groups = groupby(order, key=numbers.__getitem__)
    return [(number, [entries[index] for index in indices]) for number, indices in groups]


def _has(data: Any, key: str) -> bool:
    return isinstance(data, dict) and key in data


def _items(data: Any, where: str) -> Sequence[dict[str, Any]]:
    """Return the entries of persons, which may be under a key."""
    keys = [key for key in ("annotations", "instances", "people") if isinstance(data, dict) and key in data]
    return objects(data, where, keys[0] if keys else "")


def _image_numbers(data: Any) -> dict[str, int]:
    """Return the numbers in the file names of images by their IDs, where there are such for all of them."""
    images = objects(data, "images", "images") if isinstance(data, dict) and "images" in data else ()
    try:
        return {str(image["id"]): _number(image["file_name"]) for image in images}
    except (KeyError, TypeError, UnusableFileError):
        return {}


def _frame_number(entry: Mapping[str, Any], where: str) -> int:
    for key in _FRAMES:
        if key in entry:
            return _number(entry[key])
    raise UnusableFileError(
        f"{where}: a person has no {' or '.join(_FRAMES)}; export it again, or a file for each frame"
    )


def _number(name: Any) -> int:
    """Return the number of a frame, which may stand at the end of a file name."""
    digits = re.findall(r"[0-9]+", str(name).rpartition("/")[2])
    if not isinstance(name, (int, str)) or not digits or len(digits[-1]) > 15:
        raise UnusableFileError("a frame has no number; name images by numbers that rise")
    return int(digits[-1])


def _labels(data: Any) -> tuple[str, ...]:
    """Return the labels of annotations' points, if they say them."""
    categories = data.get("categories") if isinstance(data, dict) else None
    first = categories[0] if isinstance(categories, list) and categories else None
    labels = first.get("keypoints") if isinstance(first, dict) else None
    return tuple(map(str, labels)) if isinstance(labels, list) else ()


def _persons(entries: Iterable[Mapping[str, Any]], where: str) -> list[Person]:
    return [person(_identity(entry), _flat(entry, where), where) for entry in entries if entry.get("keypoints")]


def _identity(entry: Mapping[str, Any]) -> str:
    return next((name for key in _IDENTITIES if (name := identity(entry.get(key)))), "")


def _flat(entry: Mapping[str, Any], where: str) -> Sequence[float]:
    """Return x, y and confidence of each point, one after the other.

    The third number of annotations is 0, 1 (hidden) or 2 (seen): half of it is the confidence.
    """
    points, scores = entry["keypoints"], entry.get("keypoint_scores")
    try:
        if isinstance(points[0], list):
            if scores is not None:
                points = [[*point[:2], score] for point, score in zip(points, scores, strict=True)]
            points = [number for point in points for number in point]
        elif 2 in points[2::3] and {*points[2::3]} <= {0, 1, 2}:
            points = [number / 2 if index % 3 == 2 else number for index, number in enumerate(points)]
    except (TypeError, ValueError, KeyError):
        raise UnusableFileError(f"{where}: keypoints are damaged; export it again") from None
    return points
