"""COCO keypoints: results, annotations and what MMPose and AlphaPose write, a file for each frame or one for all.

Files may name their own keypoints: COCO's in categories, MMPose's in `meta_info`.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from mimoc.base.errors import counted
from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.checks import drop_unsure
from mimoc.motion.frame_files import (
    first_bytes,
    frame_places,
    numbers_of_files,
    objects,
    parse,
    parse_frames,
    read_frame_files,
    read_whole_file,
)
from mimoc.motion.labels import known_name
from mimoc.motion.persons import Frame, Person, identity, person, place_points
from mimoc.motion.point_recording import PointRecording, ReadOptions

SOURCES = "categories", "meta_info", "dataset_meta"
"""Keys under which they stand: the first is COCO's, the others are MMPose's."""
_LISTS = "keypoint_names", "keypoints", "joint_names"
_INFANTS = {"infant", "infants", "baby", "babies", "newborn", "neonate", "child", "toddler", "preterm", "kid"}
"""Words in the names of categories that are those of infants, unless one of the next is there, too."""
_DENIALS = {"no", "not", "non", "other"}
_HIPS = {"left_hip", "right_hip"}
_MAX_LISTED = 5


@dataclass(frozen=True, slots=True)
class KeypointNames:
    """The labels of the points of persons."""

    labels: tuple[str, ...] = ()  # Labels of the points of all persons, in one order; empty if the file has none.
    columns: Mapping[str, Sequence[int]] = field(default_factory=dict)
    """Places among the labels of the points of each category whose persons may be the infant, by its ID. Empty if the
    points of all persons are the labels."""
    notes: tuple[str, ...] = ()
    is_asked_for: bool = False  # Whether a user has called the infant by its category.

    def placed(self, entry: Mapping[str, Any], numbers: Sequence[Any], where: str) -> Sequence[Any]:
        """Return a person's numbers, three a point, in the order of labels, or raise an UnusableFileError."""
        columns = self.columns.get(_category_of(entry), range(len(self.labels)))
        if not self.labels:
            return numbers
        if len(numbers) != 3 * len(columns):
            raise UnusableFileError(
                f"{one_line(where)}: a person has {len(numbers)} numbers, and not 3 for each of {len(columns)} points, "
                "whose names the file has; export it again"
            )
        if not self.columns:
            return numbers
        placed: list[Any] = [0.0] * (3 * len(self.labels))
        for index, column in enumerate(columns):
            placed[3 * column : 3 * column + 3] = numbers[3 * index : 3 * index + 3]
        return placed

    def takes(self, entry: Mapping[str, Any]) -> bool:
        """Return whether an entry may be the infant's."""
        return not self.columns or _category_of(entry) in self.columns


def keypoint_names(data: Any, entries: Iterable[Mapping[str, Any]], infant: str | None) -> KeypointNames:
    """Return the labels that a file has for the points of its persons, by category, or raise an UnusableFileError.

    Without *infant*, what a user calls it, only persons of a category that is called an infant count, if there is one.
    """
    if not isinstance(data, dict):
        return KeypointNames()
    meta = next((data[key] for key in SOURCES[1:] if isinstance(data.get(key), dict)), {})
    if labels := _labels_of_mmpose(meta):
        return KeypointNames(labels)
    categories = _categories(data)
    if len(categories) < 2:
        return KeypointNames(next((labels for _, labels in categories.values()), ()))
    used = {_category_of(entry): None for entry in entries if entry.get("keypoints")}
    unknown = [category for category in used if category not in categories]
    if unknown:
        raise UnusableFileError(
            f"a person has the category_id {one_line(unknown[0])}, and names of keypoints have only "
            f"{one_line(first_of([*categories], _MAX_LISTED))}; export it again"
        )
    chosen = _of_infants({category: categories[category] for category in used}, infant)
    labels = tuple(dict.fromkeys(label for category in chosen for label in categories[category][1]))
    columns = {category: [labels.index(label) for label in categories[category][1]] for category in chosen}
    names = [categories[category][0] for category in chosen]
    others = [categories[category][0] for category in used if category not in chosen]
    taken, left_out = (one_line(first_of(some, _MAX_LISTED)) for some in (names, others))
    note = f"persons of the category {taken} are taken, and not of {left_out}"
    return KeypointNames(labels, columns, (note,) if others else (), infant in names)


def _of_infants(categories: Mapping[str, tuple[str, tuple[str, ...]]], infant: str | None) -> list[str]:
    """Return the IDs of categories, given with their names and labels, of which the infant may be."""
    asked = [category for category, (name, _) in categories.items() if name == infant]
    if asked:
        return asked
    words = {category: {*re.findall("[a-z]+", name.lower())} for category, (name, _) in categories.items()}
    infants = [category for category, some in words.items() if some & _INFANTS and not some & _DENIALS]
    if infants and infant is None:
        return infants
    return [id for id, (_, labels) in categories.items() if {*map(known_name, labels)} >= _HIPS] or [*categories]


def _categories(data: Mapping[str, Any]) -> dict[str, tuple[str, tuple[str, ...]]]:
    categories = data.get("categories")
    if not isinstance(categories, list):
        return {}
    known = [category for category in categories if isinstance(category, dict) and category.get("keypoints")]
    return {
        str(category.get("id")): (str(category.get("name", category.get("id"))), _labels(category["keypoints"]))
        for category in known
    }


def _category_of(entry: Mapping[str, Any]) -> str:
    return str(entry.get("category_id"))


def _labels_of_mmpose(meta: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the labels in what MMPose tells of a data set: `keypoint_id2name`, or the same in other forms."""
    try:
        if by_id := meta.get("keypoint_id2name"):
            return _in_order([(int(number), name) for number, name in by_id.items()])
        if by_name := meta.get("keypoint_name2id"):
            return _in_order([(int(number), name) for name, number in by_name.items()])
        if info := meta.get("keypoint_info"):
            points = info.values() if isinstance(info, dict) else info
            return _in_order([(int(point["id"]), point["name"]) for point in points])
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError):
        raise UnusableFileError("has damaged names of keypoints in meta_info; export it again") from None
    return next((_labels(meta[key]) for key in _LISTS if meta.get(key)), ())


def _in_order(numbered: Sequence[tuple[int, Any]]) -> tuple[str, ...]:
    ordered = sorted(numbered, key=lambda pair: pair[0])
    if [number for number, _ in ordered] != [*range(len(ordered))]:
        raise ValueError("numbers are missing")
    return _labels([label for _, label in ordered])


def _labels(labels: Any) -> tuple[str, ...]:
    if not isinstance(labels, list) or not all(isinstance(label, str) for label in labels):
        raise UnusableFileError("has names of keypoints that are not a list of texts; export it again")
    if len({*labels}) < len(labels):
        raise UnusableFileError("has a name of keypoints twice; export it again")
    return tuple(labels)


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
MIN_SCORE = 0.3  # MMPose draws points from this on (default of its `kpt_thr`).
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
    frames, names, notes = _from_folder(path, options) if path.is_dir() else _from_file(path, options)
    width = next((len(infant.numbers) for frame in frames for infant in frame.persons), 0)
    labels = names.labels or LAYOUTS.get(width // 3, ())
    if not labels or width % 3:
        known = ", ".join(map(str, LAYOUTS))
        raise UnusableFileError(f"has {counted(width, 'number')} a person; mimoc knows {known} points of 3 numbers")
    if names.is_asked_for:
        options = replace(options, infant=None)
    least = options.least_score(MIN_SCORE)
    positions, confidence, more = place_points(frames, options, len(labels), least)
    recording = PointRecording(path.stem, math.nan, labels, positions, confidence, notes=(*notes, *more))
    return drop_unsure(recording, least)


class _Film(NamedTuple):
    """Frames, and the names of their points."""

    frames: list[Frame]
    names: KeypointNames
    notes: tuple[str, ...]


def _from_folder(path: Path, options: ReadOptions) -> _Film:
    files = read_frame_files(path, ".json")
    data = {name: (place, content) for place, name, content in parse_frames(files)}
    entries = {name: _items(content, name) for name, (_, content) in data.items()}
    named = {str([content.get(key) for key in SOURCES]) for _, content in data.values() if isinstance(content, dict)}
    if len(named) > 1:
        raise UnusableFileError("has files with other names of keypoints; give a folder with one recording")
    first = next((content for _, content in data.values()), None)
    names = keypoint_names(first, chain.from_iterable(entries.values()), _asked(options))
    frames = [Frame(place, name, _persons(entries[name], names, name)) for name, (place, _) in data.items()]
    return _Film(frames, names, (*files.notes, *names.notes))


def _from_file(path: Path, options: ReadOptions) -> _Film:
    data = parse(read_whole_file(path))
    by_frame = _by_frame(data, path.name)
    if not by_frame:
        raise UnusableFileError("has no frames; check what the pose estimator was given")
    numbers = numbers_of_files([name for name, _ in by_frame])
    if numbers is None:
        raise UnusableFileError("a frame has no number; name images by numbers that rise")
    ordered = sorted(zip(numbers, by_frame, strict=True), key=lambda numbered: numbered[0])
    places, notes = frame_places([number for number, _ in ordered], [f"frame {name}" for _, (name, _) in ordered])
    names = keypoint_names(data, chain.from_iterable(items for _, items in by_frame), _asked(options))
    frames = [
        Frame(place, f"frame {number}", _persons(items, names, f"frame {number}"))
        for place, (number, (_, items)) in zip(places, ordered, strict=True)
    ]
    return _Film(frames, names, (*notes, *names.notes))


def _asked(options: ReadOptions) -> str | None:
    return None if options.infant is None else str(options.infant)


def _by_frame(data: Any, where: str) -> list[tuple[str, Sequence[Mapping[str, Any]]]]:
    """Return the name of each frame, which has its number in it, and the entries of persons."""
    frames = objects(data, where, "instance_info") if _has(data, "instance_info") else data
    if isinstance(frames, list) and frames and all(_has(frame, "instances") for frame in frames):
        return [(_frame_name(frame, where), objects(frame, where, "instances")) for frame in frames]
    entries = _items(data, where)
    images = _image_names(data)
    ids = [str(entry.get("image_id")) for entry in entries]
    is_known = bool(images) and {*ids} <= images.keys()
    by_name: dict[str, list[Mapping[str, Any]]] = {}
    for id, entry in zip(ids, entries, strict=True):
        by_name.setdefault(images[id] if is_known else _frame_name(entry, where), []).append(entry)
    return [*by_name.items()]


def _has(data: Any, key: str) -> bool:
    return isinstance(data, dict) and key in data


def _items(data: Any, where: str) -> Sequence[dict[str, Any]]:
    keys = [
        key for key in ("annotations", "instances", "instance_info", "people") if isinstance(data, dict) and key in data
    ]
    return objects(data, where, keys[0] if keys else "")


def _image_names(data: Any) -> dict[str, str]:
    """Return the file names of images by their IDs, where there are such, with numbers, for all of them."""
    images = objects(data, "images", "images") if isinstance(data, dict) and "images" in data else ()
    names = {str(image.get("id")): str(image.get("file_name")) for image in images}
    return names if numbers_of_files([*names.values()]) else {}


def _frame_name(entry: Mapping[str, Any], where: str) -> str:
    name = next((entry[key] for key in _FRAMES if key in entry), None)
    if not isinstance(name, (int, str)):
        raise UnusableFileError(
            f"{where}: a person has no {' or '.join(_FRAMES)}; export it again, or a file for each frame"
        )
    return str(name)


def _persons(entries: Iterable[Mapping[str, Any]], names: KeypointNames, where: str) -> list[Person]:
    chosen = [entry for entry in entries if entry.get("keypoints") and names.takes(entry)]
    return [
        person(
            next((name for key in _IDENTITIES if (name := identity(entry.get(key)))), ""),
            names.placed(entry, _flat(entry, where), where),
            where,
        )
        for entry in chosen
    ]


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
