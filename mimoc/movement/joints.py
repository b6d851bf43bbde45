"""What legs do whose points are known in space: angles of joints, how they move together, kicks, leg movements."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.measures import correlation, kicks_of, stand_ins
from mimoc.runtime.quantities.movement_units import unit_spans

PAIRS = ("hip", "knee"), ("knee", "ankle"), ("hip", "ankle")
LONGEST_LAG_S = 0.5


def joint_measures(recording: PointRecording, sides: Sequence[str] = SIDES) -> dict[str, float]:
    """Return what is measured of the joints of the legs of some sides; nothing if places in space are not known."""
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
    most = min(int(LONGEST_LAG_S * rate_hz), len(first) // 4)
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
        speed, acceleration = np.linalg.norm(np.gradient(ankle, axis=0), axis=1), _acceleration(ankle, rate_hz)
        for start, _, stop in unit_spans(speed * rate_hz / trunk_m):
            lengths_s.append((stop - start) / rate_hz)
            peaks_m_s2.append(float(acceleration[start : stop + 1].max()))
    if not lengths_s:
        return {}
    return {"leg_movement_s": float(np.mean(lengths_s)), "leg_movement_m_s2": float(np.mean(peaks_m_s2))}


def _acceleration(path_m: FloatArray, rate_hz: float) -> FloatArray:
    velocity = np.gradient(path_m, axis=0) * rate_hz
    return np.linalg.norm(np.gradient(velocity, axis=0) * rate_hz, axis=1)
