"""All measures of movement of one recording: the core, further ones, and those of joints that are known in space.

Further ones are of units, pauses, places, bursts over limbs, the centroid of motion and kicks; those of joints are of
their angles, how they move together, kicks and leg movements.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from mimoc.base.classes import takes
from mimoc.base.movement_quantities import DETAILS
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.head_and_gaze import head_measures
from mimoc.movement.measures import (
    LIMB_POINTS,
    MOVING_TRUNK_S,
    STILL,
    TrunkPaths,
    core_of,
    correlation,
    kicks_of,
    leg_lengths,
    stand_ins,
    trunk_paths,
    unit_spans,
)

PAIRS = ("hip", "knee"), ("knee", "ankle"), ("hip", "ankle")
MAX_LAG_S = 0.5


def joint_measures(recording: PointRecording, sides: Sequence[str] = SIDES) -> dict[str, float]:
    """Return what is measured of the legs of some sides and of the head; nothing if places in space are not known."""
    places_m = _in_space(recording)
    if places_m is None:
        return {}
    angles_deg = _angles(places_m)
    middle = (places_m["left_hip"] + places_m["right_hip"]) / 2
    trunk_m = float(np.median(np.linalg.norm(places_m["neck"] - middle, axis=1)))
    values = _of_kicks(angles_deg, places_m, trunk_m, recording.rate_hz, sides)
    values |= _of_movements(places_m, trunk_m, recording.rate_hz, sides)
    for first, second in PAIRS:
        if f"left_{second}" in angles_deg:
            pairs = [(angles_deg[f"{side}_{first}"], angles_deg[f"{side}_{second}"]) for side in sides]
            values[f"{first}_{second}_r"] = float(np.mean([correlation(*pair) for pair in pairs]))
    values |= head_measures(places_m, recording.rate_hz)
    values["hips_together_r"] = correlation(angles_deg["left_hip"], angles_deg["right_hip"])
    legs = [(angles_deg[f"{side}_hip"], angles_deg[f"{side}_knee"]) for side in sides]
    values["hip_knee_lag_s"] = float(np.mean([lag_s(hip, knee, recording.rate_hz) for hip, knee in legs]))
    return {name: value for name, value in values.items() if math.isfinite(value)}


def joint_angles(recording: PointRecording) -> dict[str, FloatArray]:
    """Return the angles of `left_hip`, `right_knee` and so on, shape (t,) each, [deg]; none of points in a picture.

    A straight leg in line with the trunk has 180 degrees at hip and knee. Ankles need points at ankles and toes.
    """
    places_m = _in_space(recording)
    return {} if places_m is None else _angles(places_m)


def lag_s(first: FloatArray, second: FloatArray, rate_hz: float) -> float:
    """Return by how much *second* is later than *first*: the lag at which they correlate most."""
    most = min(int(MAX_LAG_S * rate_hz), len(first) // 4)
    lags = range(-most, most + 1)
    count = len(first) - 2 * most
    fits = [correlation(first[most : most + count], second[most + lag : most + lag + count]) for lag in lags]
    return (int(np.argmax(fits)) - most) / rate_hz


def _in_space(recording: PointRecording) -> Mapping[str, FloatArray] | None:
    """Return the smoothed places of points, shape (t, 3) each, [m], by name; None if they are not known."""
    places = recording
    if recording.unit != "m":
        if recording.depth_m is None or recording.camera is None or not np.isfinite(recording.depth_m).any():
            return None
        smooth = recording.smoothed()
        depth_m = np.asarray(smooth.depth_m)[..., None]
        away = (smooth.positions - np.asarray(recording.camera.centre_px)) / np.asarray(recording.camera.focal_px)
        arrays = np.concatenate([away * depth_m, depth_m], axis=-1)
    else:
        arrays = places.smoothed().positions
    by_name = {name: arrays[:, index] for index, name in enumerate(recording.names)}
    by_name |= {absent: by_name[present] for absent, present in stand_ins(recording.names).items()}
    return {name: path for name, path in by_name.items() if np.isfinite(path).all()}


def _angles(places_m: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    trunk = places_m["neck"] - (places_m["left_hip"] + places_m["right_hip"]) / 2
    angles = {}
    for side in SIDES:
        hip, knee, foot = (places_m[f"{side}_{part}"] for part in ("hip", "knee", "foot"))
        ankle = places_m.get(f"{side}_ankle", foot)
        angles[f"{side}_hip"] = _between(trunk, knee - hip)
        angles[f"{side}_knee"] = _between(hip - knee, ankle - knee)
        if ankle is not foot:
            angles[f"{side}_ankle"] = _between(knee - ankle, foot - ankle)
    return angles


def _between(first: FloatArray, second: FloatArray) -> FloatArray:
    across = np.linalg.norm(np.cross(first, second), axis=1)
    return np.degrees(np.arctan2(across, (first * second).sum(axis=1)))


def _of_kicks(
    angles_deg: Mapping[str, FloatArray],
    places_m: Mapping[str, FloatArray],
    trunk_m: float,
    rate_hz: float,
    sides: Sequence[str],
) -> dict[str, float]:
    """Return ranges of angles in kicks, how much angles move together in them, and the feet's largest acceleration."""
    values: dict[str, list[float]] = {}
    for side in sides:
        foot, hip = places_m[f"{side}_foot"], places_m[f"{side}_hip"]
        acceleration = _acceleration(foot, rate_hz)
        angles = {joint: angles_deg.get(f"{side}_{joint}") for joint in ("hip", "knee", "ankle")}
        for kick in kicks_of(np.linalg.norm(foot - hip, axis=1) / trunk_m, rate_hz):
            part = slice(kick.start, kick.stop + 1)
            inside = {joint: angle[part] for joint, angle in angles.items() if angle is not None}
            one = {f"{joint}_excursion_deg": float(np.ptp(angle)) for joint, angle in inside.items()}
            one |= {
                f"kick_{first}_{second}_r": correlation(inside[first], inside[second])
                for first, second in PAIRS[:2]
                if second in inside
            }
            for name, value in (one | {"kick_foot_acceleration_m_s2": float(acceleration[part].max())}).items():
                values.setdefault(name, []).append(value)
    return {name: float(np.median(some) if name.endswith("deg") else np.mean(some)) for name, some in values.items()}


def _of_movements(
    places_m: Mapping[str, FloatArray], trunk_m: float, rate_hz: float, sides: Sequence[str]
) -> dict[str, float]:
    """Return how long the movements of ankles last, and the mean of their largest accelerations."""
    lengths_s, peaks_m_s2 = [], []
    for side in sides:
        ankle = places_m.get(f"{side}_ankle", places_m[f"{side}_foot"])
        speed = np.linalg.norm(np.gradient(ankle, axis=0), axis=1)
        acceleration = _acceleration(ankle, rate_hz)
        for start, _, stop in unit_spans(speed * rate_hz / trunk_m):
            lengths_s.append((stop - start) / rate_hz)
            peaks_m_s2.append(float(acceleration[start : stop + 1].max()))
    if not lengths_s:
        return {}
    return {"leg_movement_s": float(np.mean(lengths_s)), "leg_movement_m_s2": float(np.mean(peaks_m_s2))}


def _acceleration(path_m: FloatArray, rate_hz: float) -> FloatArray:
    velocity = np.gradient(path_m, axis=0) * rate_hz
    return np.linalg.norm(np.gradient(velocity, axis=0) * rate_hz, axis=1)


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
    values |= _bursts(body) | {"centroid_spread_trunk": _centroid_spread(body)} | _places(body) | _legs(body)
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


OF_NO_SIDE = ("hands_", "feet_", "legs_", "hips_", "limbs_", "kicks_together_", "centroid_", "dimensions", "head_")
"""How the names of measures begin that are about both sides together, or about all of the body."""


def measure_sides(recording: PointRecording, space: PointRecording | None = None) -> dict[str, dict[str, float]]:
    """Return the measures of each side alone, by `left` and `right` and by the name of their quantity.

    Where a measure is the mean of both sides, or over both, it is that of one here. Points are as for
    `measure_movement`, which raises the same errors, *space* the same in space, if they are known.
    """
    body = trunk_paths(recording)
    return {side: _of_side(body, space or recording, side) for side in SIDES}


def _of_side(body: TrunkPaths, space: PointRecording, side: str) -> dict[str, float]:
    # Points of one side in place of both: measures of both are then those of one.
    other = SIDES[1 - SIDES.index(side)]

    def of_one(points: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        return {name: points.get(name.replace(f"{other}_", f"{side}_"), path) for name, path in points.items()}

    alone = replace(body, paths=of_one(body.paths), velocities=of_one(body.velocities), speeds=of_one(body.speeds))
    values = {**core_of(alone), **details_of(alone), **joint_measures(space, (side,))}
    return {name: value for name, value in values.items() if not name.startswith(OF_NO_SIDE)}


@takes("a recording of points, from mimoc.read_points", PointRecording)
def measure_movement(recording: PointRecording) -> dict[str, float]:
    """Return the measures of movement of a recording, by the name of their quantity.

    The first 21 are those that infants are compared by. What needs points that it lacks (a face), or places in space
    (joint angles), or a kick, is left out. `mimoc.base.movement_quantities` defines them all.

    Raises:
        MovementError: If points are missing or never seen, or it is too slow or too short.

    Example:
        >>> import mimoc
        >>> from mimoc.motion.body_points import film
        >>> env = mimoc.make("nine_months.yaml").unwrapped
        >>> still = env.model.key("supine").qpos[None].repeat(300, axis=0)
        >>> mimoc.measure_movement(film(env.model, still, 30.0))["kicks_per_min"]
        0.0
    """
    body = trunk_paths(recording)
    return {**core_of(body), **details_of(body), **joint_measures(recording)}
