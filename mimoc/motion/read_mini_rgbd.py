"""A sequence of MINI-RGBD (Hesse et al. 2018, ECCV workshops): joints as text, a file for each frame.

Its layout, as users of the data set describe it: `joints_2Ddep/syn_joints_2Ddep_00000.txt` with lines `x y depth joint`
in pixels, `joints_3D/syn_joints_3D_00000.txt` with lines `x y z joint`, 25 joints, as `jointlist.txt` names them. Taken
for granted, as the files do not say it: 30 frames a second; depths of more than 20, and trunks longer than 10, are
millimetres; 3D joints are in the frame of the camera (x to the right, y downwards, z away), which looks straight down.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

import numpy as np

from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.frame_files import FrameFiles, frame_names, read_frame_files
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording, ReadOptions

RATE_HZ = 30.0  # An assumption: the files do not say it.
JOINTS = (
    *("global", "leftThigh", "rightThigh", "spine", "leftCalf", "rightCalf", "spine1", "leftFoot", "rightFoot"),
    *("spine2", "leftToes", "rightToes", "neck", "leftShoulder", "rightShoulder", "head", "leftUpperArm"),
    *("rightUpperArm", "leftForeArm", "rightForeArm", "leftHand", "rightHand", "leftFingers", "rightFingers"),
    "noseVertex",
)
"""Joints of the body model SMIL; the number of a joint in the files is its index."""
POINTS = {
    "head": "head",
    "neck": "neck",
    "nose": "noseVertex",
    **{
        f"{side}_{point}": f"{side}{joint}"
        for side in ("left", "right")
        for point, joint in (
            *(("shoulder", "UpperArm"), ("elbow", "ForeArm"), ("wrist", "Hand"), ("hand", "Fingers")),
            *(("hip", "Thigh"), ("knee", "Calf"), ("ankle", "Foot"), ("foot", "Toes")),
        )
    },
}
"""The joints that are points of mimoc's: a segment of SMIL begins at its joint."""
_MAX_METRES = 20.0  # Depths above are in millimetres.
_MAX_TRUNK_M = 10.0


@dataclass(frozen=True, slots=True)
class Joints:
    """What one of the folders of a sequence has."""

    folder: str
    prefix: str
    in_space: bool


FOLDERS = (
    Joints("joints_2Ddep", "syn_joints_2Ddep_", in_space=False),
    Joints("joints_3D", "syn_joints_3D_", in_space=True),
)
"""Where a sequence has both, the first is read."""


def recognise(path: Path) -> bool:
    """Return whether it is the folder of a sequence, or one of its folders of joints."""
    return _place(path) is not None


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return the joints that are points: pixels with depth of MINI-RGBD's camera or, without 2D joints, in space.

    Raises:
        UnusableFileError: If there are no joints, or files are damaged.
    """
    place = _place(path)
    if place is None:
        raise UnusableFileError("has no folder joints_2Ddep or joints_3D; give the folder of a sequence, such as 01")
    folder, joints = place
    files = read_frame_files(folder, ".txt")
    numbers = _numbers(files)[:, [JOINTS.index(joint) for joint in POINTS.values()]]
    name = folder.parent.name if folder.name == joints.folder else folder.name
    notes = (*files.notes, *([] if options.rate_hz else [f"{RATE_HZ:g} frames/s are taken for granted"]))
    made = _in_space if joints.in_space else _in_pixels
    return replace(made(name, numbers, notes), rate_hz=options.rate_hz or RATE_HZ)


def _in_pixels(name: str, numbers: FloatArray, notes: Sequence[str]) -> PointRecording:
    depth_m = numbers[..., 2].copy()
    known = depth_m[np.isfinite(depth_m)]
    has_depth = bool(known.size and known.any())
    if has_depth and np.median(known) > _MAX_METRES:
        depth_m = depth_m / 1000
        notes = [*notes, "depths are taken for millimetres"]
    confidence = np.isfinite(numbers[..., 0]).astype(np.float64)
    return PointRecording(
        name,
        RATE_HZ,
        tuple(POINTS),
        numbers[..., :2],
        confidence,
        MINI_RGBD_CAMERA,
        depth_m if has_depth else None,
        tuple(notes),
    )


def _in_space(name: str, numbers: FloatArray, notes: Sequence[str]) -> PointRecording:
    """Return joints that a camera sees which looks down in a frame whose z axis points upwards, the lowest at 0."""
    positions = numbers * (1.0, -1.0, -1.0)
    trial = PointRecording(name, RATE_HZ, tuple(POINTS), positions, np.isfinite(positions[..., 0]).astype(np.float64))
    with np.errstate(invalid="ignore"):
        is_mm = bool(np.isfinite(positions).any()) and trial.trunk > _MAX_TRUNK_M
    positions = positions / (1000 if is_mm else 1)
    if np.isfinite(positions).any():
        positions[..., 2] -= np.nanmin(positions[..., 2])
    notes = [*notes, "the camera is taken to look straight down, the lowest point to be at the height 0"]
    notes += ["positions are taken for millimetres"] if is_mm else []
    return PointRecording(name, RATE_HZ, trial.names, positions, trial.confidence, notes=tuple(notes))


def _place(path: Path) -> tuple[Path, Joints] | None:
    for joints in FOLDERS:
        for folder in (path, path / joints.folder):
            if not (folder != path and folder.is_symlink()) and _has_joints(folder, joints):
                return folder, joints
    return None


def _has_joints(folder: Path, joints: Joints) -> bool:
    names = frame_names(folder, ".txt")
    return bool(names) and names[0].startswith(joints.prefix)


def _numbers(files: FrameFiles) -> FloatArray:
    """Return x, y and depth or z of joints, shape (t, 25, 3), NaN if missing, or raise an UnusableFileError."""
    words = [content.split() for content in files.contents]
    lines = np.array([len(of_frame) // 4 for of_frame in words])
    try:
        rows = np.fromiter(map(float, chain.from_iterable(words)), np.float64).reshape(-1, 4)
    except ValueError:
        rows = np.empty((0, 4))
    joints = rows[:, 3]
    is_whole = all(len(of_frame) % 4 == 0 for of_frame in words) and len(rows) == lines.sum()
    if not is_whole or not ((joints >= 0) & (joints < len(JOINTS)) & (joints == np.floor(joints))).all():
        wrong = next((name for name, of_frame in zip(files.names, words, strict=True) if not _are_lines(of_frame)), "")
        raise UnusableFileError(f"{one_line(wrong)}: not lines of x, y, depth or z, and a joint from 0 to 24")
    numbers = np.full((files.frames, len(JOINTS), 3), np.nan)
    numbers[np.repeat(files.places, lines), joints.astype(np.intp)] = rows[:, :3]
    return np.where(np.isfinite(numbers).all(axis=-1, keepdims=True), numbers, np.nan)


def _are_lines(words: Sequence[bytes]) -> bool:
    try:
        return {*map(float, words[3::4])} <= {*range(len(JOINTS))} and len([*map(float, words)]) % 4 == 0
    except ValueError:
        return False
