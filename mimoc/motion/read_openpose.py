"""A folder of OpenPose: JSON with `people` and their `pose_keypoints_2d`, a file for each frame."""

import math
from pathlib import Path
from typing import Any

from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion.checks import drop_unsure
from mimoc.motion.frame_files import first_bytes, objects, parse_frames, read_frame_files
from mimoc.motion.persons import Frame, Person, identity, person, place_points
from mimoc.motion.point_recording import PointRecording, ReadOptions

_COCO_18 = (
    *("Nose", "Neck", "RShoulder", "RElbow", "RWrist", "LShoulder", "LElbow", "LWrist"),
    *("RHip", "RKnee", "RAnkle", "LHip", "LKnee", "LAnkle", "REye", "LEye", "REar", "LEar"),
)
BODY_25 = (
    *(*_COCO_18[:8], "MidHip", *_COCO_18[8:]),
    *("LBigToe", "LSmallToe", "LHeel", "RBigToe", "RSmallToe", "RHeel"),
)
"""Order of the points (OpenPose's documentation, `output.md`)."""
_NECK = "Neck (middle of the shoulders)"
"""What OpenPose calls the neck was learnt from the middle of the shoulders (its maintainers, issue 1537): a label that
means no point, so that the neck is put where COCO's is."""
_LABELS = {
    3 * len(labels): tuple(_NECK if label == "Neck" else label for label in labels) for labels in (BODY_25, _COCO_18)
}
_POINTS = "pose_keypoints_2d"
MIN_SCORE = 0.05  # OpenPose draws points above this (default of its `--render_threshold`).


def recognise(path: Path) -> bool:
    """Return whether it is a folder whose first JSON file has people."""
    return path.is_dir() and b'"people"' in first_bytes(path)


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return the points of the infant; they have no frame rate.

    Raises:
        UnusableFileError: If files are damaged, or it is not clear who the infant is.
    """
    files = read_frame_files(path, ".json")
    frames = [Frame(place, name, _persons(data, name)) for place, name, data in parse_frames(files)]
    width = next((len(infant.numbers) for frame in frames for infant in frame.persons), 3 * len(BODY_25))
    if width not in _LABELS:
        raise UnusableFileError(f"has {width} numbers a person, not 75 (BODY_25) or 54 (COCO); export BODY_25")
    labels = _LABELS[width]
    least = options.least_score(MIN_SCORE)
    positions, confidence, notes = place_points(frames, options, len(labels), least)
    recording = PointRecording(path.name, math.nan, labels, positions, confidence, notes=(*files.notes, *notes))
    return drop_unsure(recording, least)


def _persons(data: Any, name: str) -> list[Person]:
    """Return those with points; OpenPose's IDs are -1 unless it tracks."""
    people = objects(data, name, "people")
    return [person(identity(entry.get("person_id")), entry[_POINTS], name) for entry in people if entry.get(_POINTS)]
