"""Kicks: how often legs stretch and bend, how far their joints turn, for how long, how fast, and how much together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

import mujoco
import numpy as np
from scipy.signal import find_peaks

from mimoc.motion.body_points import film, locate
from mimoc.motion.point_recording import smooth
from mimoc.movement.measures import KICK_TRUNK, correlation, leg_lengths, unit_spans
from mimoc.movement.trunk_frame import trunk_paths
from mimoc.senses.sense import FloatArray

SIDES = ("left", "right")
LONGEST_S = 1.0
"""Longest time before and after its peak that is searched for the phases of a kick."""
STILL = 0.1
"""A phase lasts while the leg is faster than this share of the phase's peak speed; a choice of ours."""
JOINTS = {"hip": ("hip1", -1.0), "knee": ("knee", -1.0), "ankle": ("foot1", 1.0)}
"""Hinge of each joint of a leg, and the sign that makes bending positive: towards the trunk, the thigh, the shin."""


@dataclass(frozen=True, slots=True)
class LegMotion:
    """One leg over t frames."""

    rate_hz: float
    length_trunk: FloatArray
    """Distance from hip to foot as a camera above sees it, by the length of the trunk, shape (t,)."""
    angles_deg: Mapping[str, FloatArray]
    """By joint, shape (t,) each; bending is positive."""
    speed_trunk_s: FloatArray
    """Of the ankle, in space, by the length of the trunk, shape (t,)."""
    acceleration_m_s2: FloatArray
    """Of the ankle, in space, without gravity, shape (t,)."""


@dataclass(frozen=True, slots=True)
class Kick:
    """One stretch and bend of a leg."""

    peak: int
    """Frame in which the leg is longest."""
    size_trunk: float
    excursions_deg: Mapping[str, float]
    """Range of each joint."""
    stretch_s: float
    bend_s: float
    peak_m_s2: float
    """Largest acceleration of the ankle."""
    hip_knee_r: float
    """Correlation of the two angles."""
    knee_ankle_r: float


def leg_motions(model: mujoco.MjModel, qpos: FloatArray, rate_hz: float) -> dict[str, LegMotion]:
    """Return the motion of both legs of an infant on its back, by side.

    All is without what is faster than 6 Hz, as in `mimoc movement`.

    Args:
        model: The infant.
        qpos: Its configurations, shape (t, nq).
        rate_hz: Frames per second.
    """
    lengths = leg_lengths(trunk_paths(film(model, qpos, rate_hz)))
    ankles_m = smooth(locate(model, qpos, [f"{side}_ankle" for side in SIDES]), rate_hz)
    velocity = np.gradient(ankles_m, axis=0) * rate_hz
    speed = np.linalg.norm(velocity, axis=-1) / trunk_m(model, qpos[0])
    acceleration = np.linalg.norm(np.gradient(velocity, axis=0) * rate_hz, axis=-1)
    return {
        side: LegMotion(
            rate_hz,
            lengths[slot],
            _angles_deg(model, qpos, side, rate_hz),
            speed[:, slot],
            acceleration[:, slot],
        )
        for slot, side in enumerate(SIDES)
    }


def trunk_m(model: mujoco.MjModel, qpos: FloatArray) -> float:
    """Return the distance from the neck to the middle of the hips in a configuration."""
    neck, left, right = locate(model, qpos[None], ["neck", "left_hip", "right_hip"])[0]
    return float(np.linalg.norm(neck - (left + right) / 2))


def kicks_of(leg: LegMotion) -> list[Kick]:
    """Return the kicks of a leg: maxima of its length of a prominence of at least `KICK_TRUNK`."""
    peaks, shape = find_peaks(leg.length_trunk, prominence=KICK_TRUNK)
    bases = zip(peaks, shape["left_bases"], shape["right_bases"], shape["prominences"], strict=True)
    return [_kick(leg, int(peak), int(left), int(right), float(size)) for peak, left, right, size in bases]


def phase_of(speed: FloatArray) -> slice:
    """Return the frames of a phase: those around the largest *speed*, which is positive, above a tenth of it."""
    if not len(speed) or speed.max() <= 0:
        return slice(0, 0)
    top = int(np.argmax(speed))
    slow = np.flatnonzero(speed < STILL * speed[top])
    before, after = slow[slow < top], slow[slow > top]
    return slice(int(before[-1]) + 1 if len(before) else 0, int(after[0]) if len(after) else len(speed))


def units_of(leg: LegMotion) -> list[tuple[float, float]]:
    """Return duration, [s], and largest acceleration, [m/s²], of all movement units of a leg, however small.

    A unit is a maximum of the ankle's speed, of the least height and prominence that `mimoc movement` asks for, from
    the minimum before it to the one after it.
    """
    return [
        ((stop - start) / leg.rate_hz, float(leg.acceleration_m_s2[start : stop + 1].max()))
        for start, _, stop in unit_spans(leg.speed_trunk_s)
    ]


def summarise(legs: Mapping[str, LegMotion]) -> dict[str, float]:
    """Return the measures of kicking of both legs; those of kicks are left out if there are none."""
    kicks = {side: kicks_of(leg) for side, leg in legs.items()}
    left, right = (legs[side].length_trunk for side in SIDES)
    minutes = len(left) / legs["left"].rate_hz / 60
    every = [kick for side in SIDES for kick in kicks[side]]
    units = [unit for side in SIDES for unit in units_of(legs[side])]
    return {
        "rate_per_min": len(every) / len(SIDES) / minutes,
        "left_right_r": correlation(left, right),
        **(_means(every) if every else {}),
        **(
            {"unit_s": fmean(unit[0] for unit in units), "unit_m_s2": fmean(unit[1] for unit in units)} if units else {}
        ),
    }


def _means(kicks: Sequence[Kick]) -> dict[str, float]:
    return {
        "size_trunk": fmean(kick.size_trunk for kick in kicks),
        **{f"{joint}_deg": fmean(kick.excursions_deg[joint] for kick in kicks) for joint in JOINTS},
        "stretch_s": fmean(kick.stretch_s for kick in kicks),
        "bend_s": fmean(kick.bend_s for kick in kicks),
        "peak_m_s2": fmean(kick.peak_m_s2 for kick in kicks),
        "hip_knee_r": fmean(kick.hip_knee_r for kick in kicks),
        "knee_ankle_r": fmean(kick.knee_ankle_r for kick in kicks),
    }


def _kick(leg: LegMotion, peak: int, left_base: int, right_base: int, size_trunk: float) -> Kick:
    most = round(LONGEST_S * leg.rate_hz)
    first, last = max(left_base, peak - most), min(right_base, peak + most) + 1
    speed = np.gradient(leg.length_trunk) * leg.rate_hz
    stretch, bend = phase_of(speed[first : peak + 1]), phase_of(-speed[peak:last])
    part = slice(first + stretch.start, peak + bend.stop)
    angles = {joint: angle[part] for joint, angle in leg.angles_deg.items()}
    return Kick(
        peak,
        size_trunk,
        {joint: float(np.ptp(angle)) for joint, angle in angles.items()},
        (stretch.stop - stretch.start) / leg.rate_hz,
        (bend.stop - bend.start) / leg.rate_hz,
        float(leg.acceleration_m_s2[part].max()),
        correlation(angles["hip"], angles["knee"]),
        correlation(angles["knee"], angles["ankle"]),
    )


def _angles_deg(model: mujoco.MjModel, qpos: FloatArray, side: str, rate_hz: float) -> dict[str, FloatArray]:
    addresses = {joint: model.joint(f"robot:{side}_{hinge}").qposadr[0] for joint, (hinge, _) in JOINTS.items()}
    return {
        joint: JOINTS[joint][1] * smooth(np.degrees(qpos[:, address]), rate_hz) for joint, address in addresses.items()
    }
