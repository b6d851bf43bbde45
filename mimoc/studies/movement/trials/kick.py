"""A kick: the hip of an infant on its back bends as fast as a share of its strength can bend it."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.drive import Drive, again, angle_deg, settled
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

KICK_S = 0.35  # How long the hip is driven: kicks of real infants last .23 to .33 s.
ENOUGH_DEG = 50.0  # Excursion of the hip that counts as a kick.
SHARE = 0.8  # Most of its strength that an infant may need.
SHARES = (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.8, 0.9, 1.0)
"""Shares of the hip's strength among which the least that suffices is looked for."""
GENTLE_SHARES = (0.2, 0.3, 0.4, 0.5, 0.6, 0.65, 0.7, 0.75, 0.8)
KNEES = (-1.0, 0.0, 1.0)  # What the knee does, by the share of the hip: it bends as much, does nothing, or stretches.
GENTLE_KNEES = (-1.0, -0.5, -0.25, 0.0, 0.25, 0.5)
MEAN_S = 0.05
"""Time over which accelerations are taken, as the speed changes: that of the filters of body-worn sensors, a guess."""


@dataclass(frozen=True, slots=True)
class Kick:
    """What a burst at the hip does."""

    excursion_deg: float  # How far the hip has bent at most.
    seconds: float | None  # Time to `ENOUGH_DEG`; None if it does not bend so far.
    acceleration_m_s2: float  # Peak acceleration of the foot until then.


def kick(infant: TrialInfant, start: mujoco.MjData, hip: float, knee: float) -> Kick:
    """Return what comes of bending the left hip from rest, with shares of the strength of hip and knee.

    The hip's is that of its flexors; above 0, the knee is stretched.
    """
    data, drive, step_s = again(infant, start, moving=False), Drive(infant), infant.model.opt.timestep
    before_deg, foot = angle_deg(infant, data, "left_hip1"), infant.model.body("left_foot").id
    speeds, most_deg, fastest, seconds = [np.zeros(3)], -np.inf, 0.0, None
    window, velocity = round(MEAN_S / step_s), np.zeros(6)
    for step in range(round(KICK_S / step_s)):
        data.ctrl[:] = drive(data, {"left_hip1": -hip, "left_knee": knee})
        mujoco.mj_step(infant.model, data)
        mujoco.mj_objectVelocity(infant.model, data, mujoco.mjtObj.mjOBJ_XBODY, foot, velocity, 0)
        speeds.append(velocity[3:].copy())
        bent_deg = before_deg - angle_deg(infant, data, "left_hip1")
        most_deg = max(most_deg, bent_deg)
        if seconds is None:
            fastest = max(fastest, float(np.linalg.norm(speeds[-1] - speeds[max(0, step + 1 - window)])) / MEAN_S)
            seconds = (step + 1) * step_s if bent_deg >= ENOUGH_DEG else None
    return Kick(most_deg, seconds, fastest)


def best_kick(infant: TrialInfant, start: mujoco.MjData, hip: float, knees: Sequence[float] = KNEES) -> Kick:
    """Return the kick that goes furthest among those with some share of the hip, by what the knee does."""
    return max((kick(infant, start, hip, hip * knee) for knee in knees), key=lambda one: one.excursion_deg)


def _measure(subject: Subject) -> Values:
    infant, start = subject.infant, settled(subject.infant)
    usual = best_kick(infant, start, SHARE)
    enough = [share for share in SHARES if best_kick(infant, start, share).seconds is not None]
    kicks = [kick(infant, start, hip, hip * knee) for hip in GENTLE_SHARES for knee in GENTLE_KNEES]
    accelerations = [one.acceleration_m_s2 for one in kicks if one.seconds is not None]
    return {
        "kick_deg": usual.excursion_deg,
        "kick_s": usual.seconds,
        "kick_share": min(enough, default=None),
        "kick_gentlest_m_s2": min(accelerations, default=None),
        "kick_strongest_m_s2": max(accelerations, default=None),
    }


KICK = MovementTrial(
    "kick",
    "on its back, bends a hip with at most .8 of its strength",
    _measure,
    (0.0, 1.0, 3.0, 6.0),
    (
        Quantity("kick_deg", "Kick: hip bends by", "deg"),
        Quantity("kick_s", "Kick: time to 50 degrees", "s"),
        Quantity("kick_share", "Kick: least share of strength"),
        Quantity("kick_gentlest_m_s2", "Kick: gentlest peak of the foot", "m/s²"),
        Quantity("kick_strongest_m_s2", "Kick: strongest peak of the foot", "m/s²"),
    ),
    ("left_lower_leg", "left_foot"),
    side="left",
)
