"""A reach: sitting with its trunk held, an infant brings a hand from its lap to straight ahead as fast as it can."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.policies.control.holding.controller import Controller, servo
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

SITTING_DEG = {
    "{side}_hip1": -80.0,
    "{side}_knee": -60.0,
    "{side}_elbow": -70.0,
    "{side}_shoulder_ad_ab": 25.0,
    "{side}_shoulder_horizontal": 60.0,
}
AHEAD_DEG = {"right_shoulder_horizontal": 85.0, "right_shoulder_ad_ab": 85.0, "right_elbow": -20.0}
"""The arm nearly straight, straight ahead: 12 to 15 cm from the lap at 4 to 12 months."""
PLANNED_S = tuple(round(0.1 * tenths, 1) for tenths in range(2, 26))  # Durations that are tried, the shortest first.
REACHED_M, SETTLING_S = 0.01, 0.15  # How far from its goal the hand may be, and how long after the planned end.
ABOVE_M = 0.2


@dataclass(frozen=True, slots=True)
class Reach:
    """What came of a reach."""

    miss_m: float  # Distance of the hand from its goal at the end.
    peak_m_s: float  # Greatest speed of the hand.
    way_m: float  # Distance of the goal from where the hand began.


def reach(infant: TrialInfant, planned_s: float) -> Reach:
    """Return what comes of a reach by a target of least jerk, which the controller of the milestones follows."""
    held = infant.fixed([*infant.trunk_dofs(), *infant.dofs_of("head")])
    data, hand = held.placed(0.0, SITTING_DEG, ABOVE_M), held.model.body("right_hand").id
    start, end = held.turned(data, {}), held.turned(data, AHEAD_DEG)
    arrived = mujoco.MjData(held.model)
    arrived.qpos[:] = data.qpos
    arrived.qpos[held.angles] = end
    mujoco.mj_kinematics(held.model, arrived)
    goal_m, step_s = arrived.xpos[hand].copy(), held.model.opt.timestep
    control, trace = Controller(held, servo(held, data), step_s), [data.xpos[hand].copy()]
    for step in range(round((planned_s + SETTLING_S) / step_s)):
        time = min(step * step_s / planned_s, 1.0)
        data.ctrl[:] = control(data, start + (10 * time**3 - 15 * time**4 + 6 * time**5) * (end - start))
        mujoco.mj_step(held.model, data)
        trace.append(data.xpos[hand].copy())
    way_m, miss_m = (float(np.linalg.norm(goal_m - place)) for place in (trace[0], trace[-1]))
    return Reach(miss_m, float(np.linalg.norm(np.diff(trace, axis=0), axis=1).max() / step_s), way_m)


def fastest_reach(infant: TrialInfant) -> tuple[float, Reach] | None:
    """Return the shortest planned duration, in [s], that brings the hand to its goal, and that reach; None if none."""
    reaches = ((planned_s, reach(infant, planned_s)) for planned_s in PLANNED_S)
    return next((one for one in reaches if one[1].miss_m <= REACHED_M), None)


def _measure(subject: Subject) -> Values:
    shortest = fastest_reach(subject.infant)
    if shortest is None:
        return {"reach_s": None, "reach_peak_m_s": None, "reach_way_cm": None}
    planned_s, best = shortest
    return {"reach_s": planned_s, "reach_peak_m_s": best.peak_m_s, "reach_way_cm": 100 * best.way_m}


REACH = MovementTrial(
    "reach",
    "sitting with its trunk held, brings a hand from its lap to straight ahead within 1 cm, as fast as it can",
    _measure,
    (4.0, 6.0, 9.0, 12.0),
    (
        Quantity("reach_s", "Reach: shortest duration", "s"),
        Quantity("reach_peak_m_s", "Reach: peak speed of the hand", "m/s"),
        Quantity("reach_way_cm", "Reach: way", "cm"),
    ),
    ("head", "right_upper_arm", "right_lower_arm", "right_hand"),
    held_out=True,
    side="right",
)
