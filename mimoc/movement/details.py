"""Further measures of movement: units, pauses, places, bursts over limbs, the centroid of motion, kicks."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from mimoc.base.quantities.movement_details import CENTROID, DETAILS
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import FloatArray
from mimoc.movement.measures import LIMB_POINTS, STILL, TrunkPaths, correlation, kicks_of, leg_lengths
from mimoc.runtime.quantities.movement_units import MOVING_TRUNK_S, unit_spans

AT_FACE_TRUNK = 0.4
"""A hand this near to the middle of the head is at the face: the head's radius, .07 m, and the half of a hand."""
TOUCHING_TRUNK = 0.25  # Hands or feet this near to each other are together: their breadth, .05 m.
TOGETHER_S = 0.2  # Kicks of both legs within this time are together.
PATH_HZ, PATH_STEPS = 10.0, range(1, 9)  # Rate and steps at which the complexity of a path is looked at.


def details_of(body: TrunkPaths) -> dict[str, float]:
    """Return the further measures of paths in the frame of the trunk, without those that cannot be known."""
    values: dict[str, float] = {}
    for part in ("hand", "foot"):
        values |= _of_ends(body, part)
    for part in ("hand", "foot", "elbow", "knee"):
        if part in ("elbow", "knee"):
            values[f"{part}_speed_p95_trunk_s"] = float(np.percentile(body.both(part), 95))
        values[f"{part}_acceleration_p95_trunk_s2"] = float(np.percentile(_accelerations(body, part), 95))
    values |= _bursts(body) | {CENTROID.name: _centroid_spread(body)} | _places(body) | _legs(body)
    names = [quantity.name for quantity in DETAILS if math.isfinite(values.get(quantity.name, math.nan))]
    return {name: values[name] for name in names}


def _of_ends(body: TrunkPaths, part: str) -> dict[str, float]:
    both, rate_hz = body.both(part), body.rate_hz
    units = [(speed, *span) for speed in both for span in unit_spans(speed)]
    moving = [length / rate_hz for speed in both for length in _runs(speed > MOVING_TRUNK_S)]
    still = [length / rate_hz for speed in both for length in _runs(speed <= MOVING_TRUNK_S)]
    every = max(1, round(rate_hz / PATH_HZ))
    dimensions = [path_dimension(path[::every]) for path in body.sides(part)]
    return {
        f"{part}_unit_s": _median([(stop - start) / rate_hz for _, start, _, stop in units]),
        f"{part}_unit_peak_trunk_s": _median([float(speed[peak]) for speed, _, peak, _ in units]),
        f"{part}_speed_max_trunk_s": float(both.max()),
        f"{part}_moving_mean_s": _mean(moving),
        f"{part}_moving_p90_s": _percentile(moving, 90),
        f"{part}_still_mean_s": _mean(still),
        f"{part}_still_p90_s": _percentile(still, 90),
        f"{part}_path_dimension": _mean([one for one in dimensions if math.isfinite(one)]),
    }


def path_dimension(path: FloatArray) -> float:
    """Return Higuchi's fractal dimension of a path, (t, 2), over time: 1 if smooth, 1.5 for a random walk, 2 for noise.

    With L(k) the length of the path looked at in steps of k, its mean over the k first points to begin at, it is the
    slope of ln L(k) over ln 1 / k. NaN if nothing moves.
    """
    lengths = [np.mean([_length(path, first, step) for first in range(step)]) for step in PATH_STEPS]
    if min(lengths) < STILL:
        return math.nan
    return float(np.polyfit(-np.log(PATH_STEPS), np.log(lengths), 1)[0])


def _length(path: FloatArray, first: int, step: int) -> float:
    jumps = np.linalg.norm(np.diff(path[first::step], axis=0), axis=1)
    return float(jumps.sum() * (len(path) - 1) / (len(jumps) * step) / step)


def _runs(mask: npt.NDArray[np.bool_]) -> list[int]:
    """Return the lengths of runs of what is true, without those cut by the recording's ends."""
    changes = np.flatnonzero(np.diff(mask.astype(np.int8))) + 1
    starts, lengths = changes[:-1], np.diff(changes)
    return lengths[mask[starts]].tolist()


def _accelerations(body: TrunkPaths, part: str) -> FloatArray:
    """Return how large the accelerations of a part on both sides are, shape (2, t), [trunk/s²]."""
    velocities = [body.velocities[f"{side}_{part}"] for side in SIDES]
    return np.linalg.norm([np.gradient(velocity, axis=0) * body.rate_hz for velocity in velocities], axis=-1)


def _bursts(body: TrunkPaths) -> dict[str, float]:
    moving = np.concatenate([body.both("hand"), body.both("foot")]) > MOVING_TRUNK_S
    shares = moving.mean(axis=1)
    return {
        "limbs_still_share": float((~moving).all(axis=0).mean()),
        "limbs_still_chance_share": float((1 - shares).prod()),
        "limbs_moving_share": float(moving.all(axis=0).mean()),
        "limbs_moving_chance_share": float(shares.prod()),
    }


def _centroid_spread(body: TrunkPaths) -> float:
    """Return the spread of the centroid c(t) = sum w p / sum w of the points p with speeds v > .25, w = v."""
    names = [f"{side}_{part}" for side in SIDES for part in LIMB_POINTS]
    paths, speeds = np.stack([body.paths[name] for name in names]), np.stack([body.speeds[name] for name in names])
    weights = np.where(speeds > MOVING_TRUNK_S, speeds, 0.0)
    moving = weights.sum(axis=0) > 0
    if not moving.any():
        return math.nan
    centroids = (weights[..., None] * paths).sum(axis=0)[moving] / weights.sum(axis=0)[moving, None]
    return float(np.sqrt(centroids.var(axis=0).sum()))


def _places(body: TrunkPaths) -> dict[str, float]:
    hands, feet = body.sides("hand"), body.sides("foot")
    apart = {name: np.linalg.norm(left - right, axis=1) for name, (left, right) in (("hands", hands), ("feet", feet))}
    values = {f"{name}_apart_trunk": float(np.median(gap)) for name, gap in apart.items()}
    values |= {f"{name}_touching_share": float((gap < TOUCHING_TRUNK).mean()) for name, gap in apart.items()}
    if {"left_shoulder", "right_shoulder"} <= body.paths.keys():
        pairs = zip(hands, body.sides("shoulder"), strict=True)
        above = [(hand[:, 1] > shoulder[:, 1]).mean() for hand, shoulder in pairs]
        values["hand_above_shoulder_share"] = _mean(above)
    face = next((body.paths[name] for name in ("head", "nose") if name in body.paths), None)
    if face is not None:
        away = np.min([np.linalg.norm(hand - face, axis=1) for hand in hands], axis=0)
        values["hand_to_face_share"] = float((away < AT_FACE_TRUNK).mean())
    return values


def _legs(body: TrunkPaths) -> dict[str, float]:
    lengths, rate_hz = leg_lengths(body), body.rate_hz
    left, right = (kicks_of(length, rate_hz) for length in lengths)
    kicks = [*left, *right]
    peaks = [
        float(acceleration[kick.start : kick.stop + 1].max())
        for acceleration, some in zip(_accelerations(body, "foot"), (left, right), strict=True)
        for kick in some
    ]
    together = [
        any(abs(kick.peak - other.peak) <= TOGETHER_S * rate_hz for other in others)
        for some, others in ((left, right), (right, left))
        for kick in some
    ]
    return {
        "leg_length_median_trunk": float(np.median(lengths)),
        "leg_length_p2_trunk": float(np.percentile(lengths, 2)),
        "leg_length_p98_trunk": float(np.percentile(lengths, 98)),
        "kick_amplitude_trunk": _median([kick.amplitude_trunk for kick in kicks]),
        "kick_extension_s": _mean([(kick.peak - kick.start) / rate_hz for kick in kicks]),
        "kick_flexion_s": _mean([(kick.stop - kick.peak) / rate_hz for kick in kicks]),
        "kick_extension_rate_trunk_s": _mean([kick.extension_rate_trunk_s for kick in kicks]),
        "kick_flexion_rate_trunk_s": _mean([kick.flexion_rate_trunk_s for kick in kicks]),
        "kick_acceleration_trunk_s2": _mean(peaks),
        "legs_together_r": correlation(*lengths),
        "kicks_together_share": _mean(together),
    }


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else math.nan


def _median(values: list[float]) -> float:
    return float(np.median(values)) if values else math.nan


def _percentile(values: list[float], percent: float) -> float:
    return float(np.percentile(values, percent)) if values else math.nan
