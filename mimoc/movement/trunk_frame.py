"""The paths of an infant's points in the frame of its own trunk."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.base.errors import MovementError
from mimoc.motion.point_recording import CUTOFF_HZ, FloatArray, PointRecording
from mimoc.motion.points import SIDES

LEAST_RATE_HZ = 2.5 * CUTOFF_HZ
"""Slower recordings do not contain what the filter lets pass."""
LEAST_S = 2.0
"""Shorter recordings have too few movements to measure."""
STAND_INS: Mapping[str, tuple[str, ...]] = {"hand": ("wrist",), "foot": ("big_toe", "ankle")}
"""What is measured where a pose estimator does not know a hand or a foot, the best first. Wrists and ankles move less:
speeds come out lower."""
_NEEDED = ("neck", *(f"{side}_{part}" for side in SIDES for part in ("elbow", "hand", "hip", "knee", "foot")))
"""Points that every measure can rely on."""
_WANTED = {*_NEEDED, "left_shoulder", "right_shoulder", "head", "nose"}


@dataclass(frozen=True)
class TrunkPaths:
    """Paths of points over t frames; origin at the middle of the hips, unit the length of the trunk.

    The axis *along* points from the hips to the neck, *across* is it turned by 90 degrees. With p a point, h the middle
    of the hips, n the neck and T the median of |n - h|: u = (n - h) / |n - h|, along = (p - h) . u / T.
    """

    rate_hz: float
    paths: Mapping[str, FloatArray]
    """Across and along, shape (t, 2) each, [trunk], by the name of the point."""
    velocities: Mapping[str, FloatArray]
    """Central differences, shape (t, 2) each, [trunk/s]."""
    speeds: Mapping[str, FloatArray]
    """Their lengths, shape (t,) each, [trunk/s]."""

    @property
    def minutes(self) -> float:
        """Duration of the recording."""
        return len(self.paths["neck"]) / self.rate_hz / 60

    def sides(self, part: str) -> list[FloatArray]:
        """Return the paths of a part on the left and on the right, shape (t, 2) each, [trunk]."""
        return [self.paths[f"{side}_{part}"] for side in SIDES]

    def both(self, part: str) -> FloatArray:
        """Return the speeds of a part on both sides, shape (2, t), [trunk/s]."""
        return np.stack([self.speeds[f"{side}_{part}"] for side in SIDES])


def trunk_paths(recording: PointRecording) -> TrunkPaths:
    """Return the paths of a recording's points in the frame of the trunk, without what is faster than 6 Hz.

    Points in space are taken as a camera straight above sees them from afar: by x and y.

    Raises:
        MovementError: If points are missing or never seen, or it is too slow or too short for measures of movement.
    """
    if recording.rate_hz < LEAST_RATE_HZ:
        slow = f"{recording.rate_hz:g} frames/s are too few to measure movement"
        raise MovementError(f"{recording.name}: {slow}; record at least {LEAST_RATE_HZ:g}")
    if recording.frames < LEAST_S * recording.rate_hz:
        short = f"{recording.frames} frames are too few to measure movement"
        raise MovementError(f"{recording.name}: {short}; record at least {LEAST_S:g} s")
    smooth = _with_stand_ins(recording).smoothed()
    flat = np.array(smooth.positions[..., :2])
    hips = (flat[:, smooth.names.index("left_hip")] + flat[:, smooth.names.index("right_hip")]) / 2
    trunk = flat[:, smooth.names.index("neck")] - hips
    lengths = np.linalg.norm(trunk, axis=1)
    if not lengths.min() > 0:
        raise MovementError(f"{recording.name}: the neck lies between the hips; check the names of the points")
    along = trunk / lengths[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    away = flat - hips[:, None]
    placed = np.stack([(away * axis[:, None]).sum(-1) for axis in (across, along)], axis=-1) / np.median(lengths)
    paths = {name: placed[:, index] for index, name in enumerate(smooth.names)}
    velocities = {name: np.gradient(path, axis=0) * recording.rate_hz for name, path in paths.items()}
    speeds = {name: np.linalg.norm(velocity, axis=1) for name, velocity in velocities.items()}
    return TrunkPaths(recording.rate_hz, paths, velocities, speeds)


def stand_ins(names: Sequence[str]) -> dict[str, str]:
    """Return which of a recording's points are measured in place of hands, feet and neck that it does not have."""
    chosen = {}
    for side in SIDES:
        for part, others in STAND_INS.items():
            known = [f"{side}_{name}" for name in (part, *others) if f"{side}_{name}" in names]
            if known and known[0] != f"{side}_{part}":
                chosen[f"{side}_{part}"] = known[0]
    return chosen


def _with_stand_ins(recording: PointRecording) -> PointRecording:
    """Return a recording of what is measured, with hands and feet named so, whatever stands in for them."""
    renamed = {present: absent for absent, present in stand_ins(recording.names).items()}
    kept = recording.select([name for name in recording.names if renamed.get(name, name) in _WANTED])
    names = tuple(renamed.get(name, name) for name in kept.names)
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise MovementError(f"{recording.name}: has no {', '.join(missing)}; measures of movement need all of them")
    seen: FloatArray = np.isfinite(kept.positions).all(axis=-1).max(axis=0, initial=False)
    unseen = [name for index, name in enumerate(names) if name in _NEEDED and not seen[index]]
    if unseen:
        raise MovementError(f"{recording.name}: {', '.join(unseen)} never seen; measures of movement need all of them")
    used = [index for index, name in enumerate(names) if seen[index]]
    positions, confidence = kept.positions[:, used], kept.confidence[:, used]
    return PointRecording(
        recording.name, recording.rate_hz, tuple(names[index] for index in used), positions, confidence
    )
