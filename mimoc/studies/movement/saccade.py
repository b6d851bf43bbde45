"""A saccade: an eye turns by 20 degrees as fast as its muscles can turn and stop it."""

import copy
from dataclasses import replace

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.drive import all_but, angle_deg, driven, floating
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

EYE = "left_eye_horizontal"
TURN_DEG = 20.0
STEP_S, LONGEST_S = 0.005, 0.5  # Times at which the torque turns around are tried in these steps, up to the longest.
AFTER_S = 1.0
ABOVE_M = 2.0


def saccade(infant: TrialInfant, turn_deg: float) -> tuple[float | None, float | None]:
    """Return the duration in [s] and the peak speed in [deg/s] of the fastest saccade of at least some degrees.

    The head is held, and there is no gravity. One way with all strength, then the other way until the eye stands: the
    earliest turn that brings it far enough gives the fastest. Both are None if there is none.
    """
    model = copy.copy(infant.model)
    model.opt.gravity[:] = 0.0
    held = all_but(floating(replace(infant, model=model)), EYE)
    for brake_s in np.arange(2 * STEP_S, LONGEST_S, STEP_S):
        reached_deg, seconds, peak_deg_s = _turn(held, float(brake_s))
        if reached_deg >= turn_deg:
            return seconds, peak_deg_s
    return None, None


def _turn(held: TrialInfant, brake_s: float) -> tuple[float, float, float]:
    """Return how far an eye has turned when it stands again, when that is, and its peak speed."""
    data, peak_deg_s = held.placed(0.0, {}, ABOVE_M), 0.0
    dof, step_s = int(held.model.joint(f"robot:{EYE}").dofadr[0]), held.model.opt.timestep
    for step, _ in enumerate(driven(held, data, AFTER_S, lambda time_s: {EYE: 1.0 if time_s < brake_s else -1.0})):
        time_s = step * step_s
        peak_deg_s = max(peak_deg_s, float(np.degrees(data.qvel[dof])))
        if data.qvel[dof] <= 0.0 and time_s > brake_s:
            return angle_deg(held, data, EYE), time_s, peak_deg_s
    return 0.0, AFTER_S, peak_deg_s


def _measure(subject: Subject) -> Values:
    seconds, peak_deg_s = saccade(subject.infant, TURN_DEG)
    return {"saccade_s": seconds, "saccade_peak_deg_s": peak_deg_s}


SACCADE = MovementTrial(
    "saccade",
    "turns an eye by 20 degrees as fast as it can",
    _measure,
    (0.0, 1.0, 3.0, 6.0, 12.0, 18.0),
    (
        Quantity("saccade_s", "Saccade of 20 degrees: duration", "s"),
        Quantity("saccade_peak_deg_s", "Saccade of 20 degrees: peak speed", "deg/s"),
    ),
    ("left_eye",),
    side="left",
)
