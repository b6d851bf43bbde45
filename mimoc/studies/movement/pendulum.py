"""How freely slack joints swing: the shank let go from straight, and damping ratios of the large joints.

About a posture in which it hangs, a joint obeys I q'' + c q' + (k + w) q = 0, with the inertia I of all that it moves
and its armature, its damping c, its stiffness k and the moment w of what hangs on it. Its damping ratio is
zeta = c / (2 sqrt((k + w) I)); each half swing is smaller than the one before by exp(-pi zeta / sqrt(1 - zeta²)).
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.drive import all_but, angle_deg, floating
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

SWINGING_S = 8.0
MIN_DEG = 1.0  # Half swings below this are not counted.
ABOVE_M = 3.0  # Height of the hip, clear of the floor.
JOINTS = {"hip": "left_hip1", "knee": "left_knee", "shoulder": "left_shoulder_ad_ab", "elbow": "left_elbow"}


@dataclass(frozen=True, slots=True)
class Swing:
    """How a limb swings that is let go."""

    swings: float  # Number of whole swings; a half swing ends where the limb turns, and counts half.
    rest_deg: float  # Angle of the limb to the vertical where it comes to rest, between hinge and centre of mass.
    index: float  # The first half swing by the angle from start to rest: 1 does not swing, 2 is not damped.
    period_s: float | None  # Time of the first whole swing; None if there is none.


def swing(infant: TrialInfant, joint: str, start_deg: float, posture_deg: dict[str, float]) -> Swing:
    """Return how a limb of an upright slack infant swings that is let go, nothing touched and other joints held."""
    held = all_but(floating(infant), joint)
    data = held.placed(0.0, {**posture_deg, joint: start_deg}, ABOVE_M)
    trace = [angle_deg(held, data, joint)]
    for _ in range(round(SWINGING_S / held.model.opt.timestep)):
        mujoco.mj_step(held.model, data)
        trace.append(angle_deg(held, data, joint))
    hinge = held.model.joint(f"robot:{joint}").id
    arm_m = data.subtree_com[held.model.jnt_bodyid[hinge]] - data.xanchor[hinge]
    rest_deg = float(np.degrees(np.arctan2(np.hypot(arm_m[0], arm_m[1]), -arm_m[2])))
    trace_deg = np.array(trace)
    offsets = trace_deg - trace_deg[-1]
    change = np.diff(offsets)
    turns = np.flatnonzero((change[:-1] * change[1:] <= 0) & (change[:-1] != 0)) + 1
    turns = turns[np.abs(offsets[turns]) > MIN_DEG]
    way_deg = abs(float(offsets[0]))
    first_deg = abs(float(offsets[turns[0]] - offsets[0])) if len(turns) else way_deg
    period_s = float(turns[1] * held.model.opt.timestep) if len(turns) > 1 else None
    return Swing(len(turns) / 2, rest_deg, first_deg / way_deg if way_deg else 1.0, period_s)


def damping_ratio(infant: TrialInfant, joint: str) -> float:
    """Return the damping ratio of a slack hinge, infant upright and all joints straight, by what its model says.

    Friction that does not depend on speed is not part of it.
    """
    model, data = infant.model, infant.placed(0.0, {}, ABOVE_M)
    hinge, dof = model.joint(f"robot:{joint}").id, int(model.joint(f"robot:{joint}").dofadr[0])
    unit, column = np.zeros((1, model.nv)), np.zeros((1, model.nv))
    unit[0, dof] = 1.0
    mujoco.mj_mulM(model, data, column[0], unit[0])
    body, axis = model.jnt_bodyid[hinge], data.xaxis[hinge]
    arm_m = data.subtree_com[body] - data.xanchor[hinge]
    moment_nm = model.body_subtreemass[body] * GRAVITY_M_S2 * np.linalg.norm(arm_m - axis * (arm_m @ axis))
    critical = 2.0 * np.sqrt((model.jnt_stiffness[hinge] + moment_nm) * column[0, dof])
    return float(model.dof_damping[dof] / critical)


THIGHS_LEVEL_DEG = {"left_hip1": -90.0, "right_hip1": -90.0}


def _pendulum(subject: Subject) -> Values:
    infant = subject.slack
    straight_deg = min(infant.range_deg("left_knee")[1], 0.0)
    shank = swing(infant, "left_knee", straight_deg, THIGHS_LEVEL_DEG)
    return {
        "shank_swings": shank.swings,
        "shank_rest_deg": shank.rest_deg,
        "shank_index": shank.index,
        "shank_period_s": shank.period_s,
    }


def _damping(subject: Subject) -> Values:
    infant = subject.slack
    return {f"damping_{name}": damping_ratio(infant, joint) for name, joint in JOINTS.items()}


PENDULUM = MovementTrial(
    "pendulum",
    "thighs held level, the slack shank is let go from straight",
    _pendulum,
    (0.0, 1.0, 3.0, 6.0, 12.0, 18.0),
    (
        Quantity("shank_swings", "Slack shank: swings"),
        Quantity("shank_rest_deg", "Slack shank: rest from vertical", "deg"),
        Quantity("shank_index", "Slack shank: relaxation index"),
        Quantity("shank_period_s", "Slack shank: period", "s"),
    ),
    ("left_lower_leg", "right_upper_leg"),
    side="left",
)
DAMPING = MovementTrial(
    "damping",
    "damping ratios of slack joints about hanging",
    _damping,
    (0.0, 1.0, 3.0, 6.0, 12.0, 18.0),
    tuple(Quantity(f"damping_{name}", f"Damping ratio of the {name}") for name in JOINTS),
    ("left_lower_leg", "left_lower_arm"),
    side="left",
)
