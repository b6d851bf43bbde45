"""Names that JSON files have for their own keypoints: COCO's categories, and MMPose's `meta_info`."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.labels import known_name

SOURCES = "categories", "meta_info", "dataset_meta"
"""Keys under which they stand: the first is COCO's, the others are MMPose's."""
_LISTS = "keypoint_names", "keypoints", "joint_names"
_INFANTS = {"infant", "infants", "baby", "babies", "newborn", "neonate", "child", "toddler", "preterm", "kid"}
"""Words in the names of categories that are those of infants, unless one of the next is there, too."""
_DENIALS = {"no", "not", "non", "other"}
_HIPS = {"left_hip", "right_hip"}
_SHOWN = 5


@dataclass(frozen=True, slots=True)
class KeypointNames:
    """The labels of the points of persons."""

    labels: tuple[str, ...] = ()  # Of all persons, in one order; empty if the file has none.
    columns: Mapping[str, Sequence[int]] = field(default_factory=dict)
    """Of each category whose persons may be the infant, by its ID: where its points are among the labels. Empty if
    the points of all persons are the labels."""
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
            f"{one_line(first_of([*categories], _SHOWN))}; export it again"
        )
    chosen = _of_infants({category: categories[category] for category in used}, infant)
    labels = tuple(dict.fromkeys(label for category in chosen for label in categories[category][1]))
    columns = {category: [labels.index(label) for label in categories[category][1]] for category in chosen}
    names = [categories[category][0] for category in chosen]
    others = [categories[category][0] for category in used if category not in chosen]
    taken, left_out = (one_line(first_of(some, _SHOWN)) for some in (names, others))
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
