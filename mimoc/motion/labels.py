"""From the labels that files give to points to mimoc's names for them."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mimoc.base.errors import UnknownNameError, suggestion
from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.point_recording import PointRecording

SIDES = "left", "right"
ON_SIDES = (
    *("eye", "ear", "shoulder", "elbow", "wrist", "hand", "hip", "knee", "ankle", "foot"),
    *("heel", "big_toe", "small_toe"),
)
"""On both sides, with `left_` or `right_` before: `hand` is the knuckle of the middle finger, `foot` the root of the
toes, which MINI-RGBD's body model calls hand and foot."""
MIDDLE = "head", "nose", "neck", "mid_hip"
"""`head` lies within the skull, above its centre, where MINI-RGBD's body model has its joint."""
POINTS = (*MIDDLE, *(f"{side}_{name}" for side in SIDES for name in ON_SIDES))
"""The names of all points that mimoc knows."""
MINI_RGBD_POINTS = (
    *("head", "neck"),
    *(f"{side}_{name}" for side in SIDES for name in ("shoulder", "elbow", "hand", "hip", "knee", "foot")),
)
"""The points of MINI-RGBD that the measures of movement are defined on: two in the middle, six on each side."""
_LIMBS = ("shoulder", "elbow", "wrist", "hand"), ("hip", "knee", "ankle", "foot")
BONES = (
    *(("neck", "head"), ("neck", "nose"), ("neck", "mid_hip")),
    *(
        bone
        for side in SIDES
        for arm_or_leg in _LIMBS
        for bone in (
            ("neck", f"{side}_{arm_or_leg[0]}"),
            *zip(*([f"{side}_{name}" for name in names] for names in (arm_or_leg, arm_or_leg[1:])), strict=False),
            *zip(*([f"{side}_{name}" for name in names] for names in (arm_or_leg[1:2], arm_or_leg[3:])), strict=True),
        )
    ),
)
"""Pairs of points that a stick figure connects, where both are known; a hand without a wrist hangs on its elbow."""


_PARTS = {
    **{part: (part.replace("_", ""),) for part in ON_SIDES},
    "hand": ("hand", "knuckle", "fingers", "midhand"),
    "foot": ("foot", "toes"),
    "big_toe": ("bigtoe", "hallux", "footindex"),
    "small_toe": ("smalltoe", "littletoe"),
}
_MIDDLE = {"mid_hip": ("midhip", "pelvis", "hipcenter", "hipcentre"), "neck": ("neck", "thorax")}
MARKERS = {
    "shoulder": ("sho",),
    "elbow": ("elb",),
    "wrist": ("wra", "wrb"),
    "hand": ("fin",),
    "hip": ("asi", "psi"),
    "knee": ("kne",),
    "ankle": ("ank",),
    "foot": ("toe",),
    "heel": ("hee",),
    "head": ("fhd", "bhd"),
}
"""Markers of the Plug-in Gait set, after `L` or `R`, that lie at or around a point; `C7` and `CLAV` are at the neck."""
_HIPS = "left_hip", "right_hip"
NECK_ABOVE = 0.14
"""How far the neck is above the middle of the shoulders, in the distance of that from the middle of the hips; .138 to
.149 on mimoc's bodies of 0 to 24 months."""
_MAX_LISTED = 5
_MIN_SEEN = 0.8
"""How often a marker must be seen, in how often the one is that is seen most around the same point, to count."""


def name_points(recording: PointRecording, names: Mapping[str, str] | None) -> PointRecording:
    """Return a recording whose points have mimoc's names, in their order in `POINTS`.

    What several labels name, such as two markers at a wrist, is in the middle of those that are seen; markers count
    where no label is the name itself. Points of no name that mimoc knows are left out; a neck that is missing is put
    above the shoulders.

    Args:
        recording: Its `names` are labels of a file.
        names: Names of mimoc's by label, for those that mimoc does not know or gets wrong.

    Raises:
        UnknownNameError: If *names* has other names than mimoc's.
        UnusableFileError: If *names* has labels that are not there, or no label means a point.
    """
    columns = _columns(recording.names, names or {})
    if not columns:
        shown = one_line(first_of(recording.names, _MAX_LISTED))
        raise UnusableFileError(
            f"no label is the name of a point ({shown}); say what they are: names={{'label': 'left_hip'}}"
        )
    columns = {name: _seen(recording, at) for name, at in columns.items()}
    points = [name for name in POINTS if name in columns]
    notes = [_note(name, [recording.names[index] for index in columns[name]]) for name in points]
    left_out = [name for index, name in enumerate(recording.names) if not any(index in at for at in columns.values())]
    if left_out:
        notes.append(f"left out: {one_line(first_of(left_out, _MAX_LISTED))}")
    return _with_neck(_gathered(recording, {name: columns[name] for name in points}, [note for note in notes if note]))


def known_name(label: str) -> str:
    """Return mimoc's name of a label, such as `left_hip` of `LHip` or `Baby:hip left`; "" if it has none."""
    return _NAMES.get(_plain(label), "")


def _columns(labels: Sequence[str], names: Mapping[str, str]) -> dict[str, list[int]]:
    for label, name in names.items():
        if name not in POINTS:
            raise UnknownNameError("point", name, POINTS)
        if label not in labels:
            near = suggestion(label, [one_line(known) for known in labels])
            raise UnusableFileError(f"has no point '{one_line(label)}', which is given a name; {near}")
    columns: dict[str, list[int]] = {}
    for index, label in enumerate(labels):
        name = names.get(label) or known_name(label)
        if name and (label in names or name not in names.values()):
            columns.setdefault(name, []).append(index)
    return {name: [index for index in at if not _is_marker(labels[index])] or at for name, at in columns.items()}


def _seen(recording: PointRecording, columns: list[int]) -> list[int]:
    """Return those of several markers around a point that are seen, as those on the back of an infant may not be."""
    often = np.isfinite(recording.positions[:, columns]).all(axis=-1).mean(axis=0)
    return [column for column, share in zip(columns, often.tolist(), strict=True) if share >= _MIN_SEEN * often.max()]


def _gathered(recording: PointRecording, columns: Mapping[str, list[int]], notes: list[str]) -> PointRecording:
    """Return a recording of points that are each in the middle of some of its own."""
    several = list(columns.values())
    depth_m = recording.depth_m
    return replace(
        recording,
        names=tuple(columns),
        positions=np.stack([recording.positions[:, index].mean(axis=1) for index in several], axis=1),
        confidence=np.stack([recording.confidence[:, index].min(axis=1) for index in several], axis=1),
        depth_m=None if depth_m is None else np.stack([depth_m[:, index].mean(axis=1) for index in several], axis=1),
        notes=(*recording.notes, *notes),
    )


def _with_neck(recording: PointRecording) -> PointRecording:
    shoulders = "left_shoulder", "right_shoulder"
    if "neck" in recording.names or not {*shoulders} <= {*recording.names}:
        return recording
    columns = {name: [recording.names.index(name)] for name in recording.names}
    columns["neck"] = [recording.names.index(name) for name in shoulders]
    ordered = {name: columns[name] for name in POINTS if name in columns}
    made = _gathered(recording, ordered, ["the neck is taken to be a little above the middle of the shoulders"])
    if not {*_HIPS} <= {*made.names}:
        return made
    neck = made.names.index("neck")
    hips = [made.names.index(name) for name in _HIPS]
    positions, confidence = made.positions.copy(), made.confidence.copy()
    positions[:, neck] += NECK_ABOVE * (positions[:, neck] - positions[:, hips].mean(axis=1))
    confidence[:, neck] = confidence[:, [neck, *hips]].min(axis=1)
    return replace(made, positions=positions, confidence=confidence)


def _note(name: str, labels: Sequence[str]) -> str:
    if len(labels) == 1 and not _is_marker(labels[0]):
        return ""
    return f"{name} is taken to be at {one_line(', '.join(labels))}"


def _is_marker(label: str) -> bool:
    return _plain(label) in _MARKER_NAMES


def _plain(label: str) -> str:
    """Return a label as it stands in the tables below: without the name of a subject and all but letters and digits."""
    return re.sub("[^a-z0-9]", "", label.rpartition(":")[2].lower())


def _spellings() -> Iterator[tuple[str, str]]:
    for name in MIDDLE:
        for word in _MIDDLE.get(name, (name,)):
            yield word, name
    for side in SIDES:
        for part, words in _PARTS.items():
            for word in words:
                for mark in (side, side[0]):
                    yield from ((mark + word, f"{side}_{part}"), (word + mark, f"{side}_{part}"))


def _marker_names() -> Iterator[tuple[str, str]]:
    for side in SIDES:
        for part, words in MARKERS.items():
            yield from ((side[0] + word, part if part in MIDDLE else f"{side}_{part}") for word in words)
    yield from (("c7", "neck"), ("clav", "neck"))


_MARKER_NAMES = dict(_marker_names())
_NAMES = _MARKER_NAMES | dict(_spellings())
