"""Left and right: where pose estimators exchange them, and which side of an infant a camera sees."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording, Up

_LIMBS: Mapping[str, Sequence[str]] = {
    "arms": ("shoulder", "elbow", "wrist", "hand"),
    "legs": ("hip", "knee", "ankle", "foot", "heel", "big_toe", "small_toe"),
}
"""Points that estimators exchange as one."""
_JUMP = 0.25
"""Least mean distance, in trunks, that the points of both limbs jump from a frame to the next if they are exchanged:
hips alone, which are closest together, are .21 to .29 apart. Limbs that move need several frames for it."""
_RATIO = 1 / 3  # How much shorter the way must be if left and right are exchanged back.
_MIN_ACROSS = 0.1  # Least area of the front, in squares of the trunk's length; less is seen of an infant on its side.
_TURNS: Mapping[str, npt.NDArray[np.int_]] = {
    "x": np.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]]),
    "-x": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    "y": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "-y": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-z": np.array([[1, 0, 0], [0, -1, 0], [0, 0, -1]]),
}
"""Rotations that turn an axis to z."""
_MIN_BEND = 0.3  # Sine of the angle, about the infant's left, from which on a knee is clearly bent.


def repair_exchanges(recording: PointRecording) -> PointRecording:
    """Return a recording without frames in which the left and right arm or leg are exchanged, and a note of them.

    Limbs are exchanged from a frame on, and back, where all their points jump to where those of the other side were.
    Those of fewer frames are taken to be wrong.
    """
    columns = np.arange(len(recording.names))[None].repeat(recording.frames, axis=0)
    notes = []
    for limb, parts in _LIMBS.items():
        pairs = [(f"left_{part}", f"right_{part}") for part in parts]
        index = [[recording.names.index(name) for name in pair] for pair in pairs if {*pair} <= {*recording.names}]
        if len(index) > 1:
            left, right = np.array(index).T
            wrong = _exchanged(recording.positions[:, left], recording.positions[:, right], recording.trunk)
            columns[np.ix_(wrong, [*left, *right])] = [*right, *left]
            if wrong.any():
                notes.append(f"left and right {limb} were exchanged in {wrong.sum():,} frames, and are put right")
    return reorder(recording, columns, notes) if notes else recording


def reorder(recording: PointRecording, columns: npt.NDArray[np.intp], notes: Sequence[str]) -> PointRecording:
    """Return a recording in which a point is, in each frame, where another one was: index, shape (t, k)."""
    depth_m = recording.depth_m
    return replace(
        recording,
        positions=np.take_along_axis(recording.positions, columns[..., None], axis=1),
        confidence=np.take_along_axis(recording.confidence, columns, axis=1),
        depth_m=None if depth_m is None else np.take_along_axis(depth_m, columns, axis=1),
        notes=(*recording.notes, *notes),
    )


def swapped(recording: PointRecording) -> PointRecording:
    """Return a recording in which what was called left is right."""
    names = [_other_side(name) for name in recording.names]
    known = [name for name in recording.names if name in names]
    return replace(recording, names=tuple(names)).select(known)


def mirrored(recording: PointRecording, axis: int = 0) -> PointRecording:
    """Return a recording of which an axis points the other way; pixels stay in the picture, as far as it is known."""
    positions = recording.positions.copy()
    x = positions[..., axis]
    middle = recording.camera.centre_px[0] if recording.camera else float(np.nanmin(x) + np.nanmax(x)) / 2
    positions[..., axis] = (2 * middle if recording.unit == "px" else 0.0) - x
    return replace(recording, positions=positions)


def _other_side(name: str) -> str:
    for side, other in (SIDES, SIDES[::-1]):
        if name.startswith(f"{side}_"):
            return other + name.removeprefix(side)
    return name


def share_from_behind(recording: PointRecording) -> float:
    """Return in what share of frames a picture shows the back, of those in which it shows front or back; NaN of none.

    From the front, with y downwards, the infant's left is at the right of a line from the hips to the neck.
    """
    across = _across(recording)
    along = recording.path("neck") - recording.hips
    area = (across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0]) / recording.trunk**2
    clear = np.abs(area) > _MIN_ACROSS
    return float((area[clear] > 0).mean()) if clear.any() else np.nan


def share_opposed(recording: PointRecording) -> float:
    """Return in what share of frames the left hip is on the side of the right shoulder; NaN if it is never known."""
    if not {f"{side}_shoulder" for side in SIDES} <= {*recording.names}:
        return np.nan
    hips, shoulders = (recording.path(f"left_{part}") - recording.path(f"right_{part}") for part in ("hip", "shoulder"))
    along = (hips * shoulders).sum(axis=1)
    along = along[np.isfinite(along)]
    return float((along < 0).mean()) if along.size else np.nan


def share_of_knees_backwards(recording: PointRecording) -> float:
    """Return in what share of the frames in which knees are clearly bent they bend the wrong way; NaN if none are.

    Needs places in space, or depth: a knee bends about the infant's left, *thigh* x *shank*, whatever its hip does.
    """
    places = _in_space(recording)
    left = _unit(_across(places))
    bends = []
    for side in SIDES:
        end = next((name for name in (f"{side}_ankle", f"{side}_foot") if name in places.names), "")
        if end and f"{side}_knee" in places.names:
            knee = places.path(f"{side}_knee")
            thigh = _unit(knee - places.path(f"{side}_hip"))
            shank = _unit(places.path(end) - knee)
            bends.append((np.cross(thigh, shank) * left).sum(axis=1))
    bent = np.concatenate(bends) if bends else np.empty(0)
    bent = bent[np.abs(bent) > _MIN_BEND]
    return float((bent < 0).mean()) if bent.size else np.nan


def facing(recording: PointRecording) -> FloatArray:
    """Return where the front of a trunk in space faces, in each frame in which it is seen: unit vectors, shape (n, 3).

    It is *left* x *up the trunk*.
    """
    faces = _unit(np.cross(_across(recording), recording.path("neck") - recording.hips))
    return faces[np.isfinite(faces).all(axis=1)]


def turned(recording: PointRecording, up: Up | None) -> PointRecording:
    """Return places in space turned so that the axis *up* is z, and otherwise as they are."""
    if recording.unit == "px" or up in (None, "z"):
        return recording
    return replace(recording, positions=recording.positions @ _TURNS[up].T)


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0, lengths, np.nan)


def _exchanged(left: FloatArray, right: FloatArray, trunk: float) -> npt.NDArray[np.bool_]:
    """Return in which frames two limbs, shape (t, p, d), are exchanged."""
    after = np.stack([left, right], axis=1)
    seen = np.isfinite(after).all(axis=-1, keepdims=True)
    frames = np.arange(len(after)).reshape(-1, *([1] * (after.ndim - 1)))
    last = np.maximum.accumulate(np.where(seen, frames, 0), axis=0)
    before = np.take_along_axis(after, last, axis=0)[:-1]
    kept, crossed = (_distance(after[1:], earlier) / trunk for earlier in (before, before[:, ::-1]))
    with np.errstate(invalid="ignore"):
        changes = (kept > _JUMP) & (crossed < _RATIO * kept)
    wrong = np.concatenate([[False], np.cumsum(changes) % 2 == 1])
    return ~wrong if wrong.mean() > 0.5 else wrong


def _distance(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the mean distance of points, shape (t, 2, p, d), that are seen on both sides; NaN if none are."""
    apart = np.linalg.norm(one - other, axis=-1).mean(axis=1)
    seen = np.isfinite(apart)
    number = seen.sum(axis=-1)
    return np.where(seen, apart, 0.0).sum(axis=-1) / np.where(number, number, np.nan)


def _across(recording: PointRecording) -> FloatArray:
    """Return vectors from right to left, by the hips and, if they are known, the shoulders."""
    parts = [part for part in ("hip", "shoulder") if {f"{side}_{part}" for side in SIDES} <= {*recording.names}]
    return np.sum([recording.path(f"left_{part}") - recording.path(f"right_{part}") for part in parts], axis=0)


def _in_space(recording: PointRecording) -> PointRecording:
    if recording.depth_m is None:
        return recording
    camera = recording.camera or MINI_RGBD_CAMERA
    depth_m = recording.depth_m[..., None]
    flat = (recording.positions - np.asarray(camera.centre_px)) / np.asarray(camera.focal_px) * depth_m
    return replace(recording, positions=np.concatenate([flat, depth_m], axis=-1), depth_m=None)
