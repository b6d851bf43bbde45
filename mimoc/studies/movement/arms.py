"""Arms and eyes: a hand kept above the shoulder, a reach from the lap, and a saccade, as fast as muscles can."""

import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2
from mimoc.compiler.measuring import ROOT
from mimoc.policies.control.holding import Controller, servo
from mimoc.runtime.sense import FloatArray
from mimoc.studies.milestones.trial import TrialInfant
from mimoc.studies.movement.trial import (
    QUIET,
    Drive,
    MovementTrial,
    Subject,
    Values,
    again,
    all_but,
    angle_deg,
    driven,
    floating,
    hinges_below,
    settled,
)

JOINTS = ("shoulder_horizontal", "shoulder_ad_ab", "shoulder_rotation", "elbow")
SAMPLES, SEED = 3000, 0  # Postures of the arm among which the one is chosen that is to be held.
BENT_RAD, MIN_BENT_RAD = np.radians(-140.0), -0.1
"""Elbow while the upper arm is lifted; an elbow that is held up is not quite straight, where its range ends."""
SIDEWAYS, TRAVEL = 0.3, 0.002
"""What a posture loses against its height for each metre beside the shoulder, and each radian of its joints."""
TIMES_S = (0.0, 1.0, 3.0, 4.0, 6.0)
"""When the elbow begins to bend, is bent, the upper arm is up, the elbow is straight, and the end."""
HELD_S = 1.0
EVERY = 10  # Physics steps between two beginnings of the second in which the hand is to stay up.
SETTLING_S = 2.0
PULL = 0.25  # Pull at the hand by the weight of the arm, against which newborns keep an arm up that they see.


def arm_lift(infant: TrialInfant, pull: float = 0.0) -> float:
    """Return the height above the shoulder that a hand keeps for one second, by the length of the arm.

    The elbow bends, the shoulder turns the upper arm up, and the elbow straightens, by smooth targets of the controller
    of the milestones; everything but the arm is quiet. Best second of six. A *pull* at the hand towards the toes, in
    weights of the arm, is countered as weight is, as newborns do that see their arm.
    """
    resting = settled(infant, SETTLING_S)
    places = [int(infant.model.joint(f"robot:left_{name}").qposadr[0]) for name in JOINTS]
    targets = _targets(infant, resting, places)
    data = again(infant, resting, moving=False)
    step_s = infant.model.opt.timestep
    data.act[:] = 0.0
    gains, drive = servo(infant, data), Drive(infant)
    control = Controller(infant, gains, step_s)
    pull_n = pull * _pull_n(infant, resting)
    arm = np.isin(infant.model.actuator_trnid[:, 0], hinges_below(infant, "left_upper_arm"))
    shoulder, hand = (infant.model.body(name).id for name in ("left_upper_arm", _knuckles(infant)))
    heights = []
    for step in range(round(TIMES_S[-1] / step_s)):
        target = targets(step * step_s) - _torques(infant, data, pull_n) / gains.stiffness_nm
        data.ctrl[:] = np.where(arm, control(data, target), drive(data, QUIET))
        data.body("left_hand").xfrc_applied[:3] = pull_n
        mujoco.mj_step(infant.model, data)
        heights.append(data.xpos[hand, 2] - data.xpos[shoulder, 2])
    second = round(HELD_S / step_s)
    held_m = max(min(heights[start : start + second]) for start in range(0, len(heights) - second, EVERY))
    bodies = ("left_upper_arm", "left_lower_arm", "left_hand", _knuckles(infant))
    points = [resting.body(name).xpos for name in bodies]
    return float(held_m / float(sum(np.linalg.norm(end - start) for start, end in pairwise(points))))


def _pull_n(infant: TrialInfant, resting: mujoco.MjData) -> FloatArray:
    """Return a force of the arm's weight from the head towards the toes of an infant on its back, shape (3,)."""
    way = resting.body(ROOT).xpos - resting.body("left_upper_arm").xpos
    way = np.array([way[0], 0.0, 0.0])
    weight_n = GRAVITY_M_S2 * float(infant.model.body_subtreemass[infant.model.body("left_upper_arm").id])
    return weight_n * way / np.linalg.norm(way)


def _torques(infant: TrialInfant, data: mujoco.MjData, pull_n: FloatArray) -> FloatArray:
    """Return the torques of a force on the hand at the driven hinges, shape (n,)."""
    jacobian = np.zeros((3, infant.model.nv))
    mujoco.mj_jacBodyCom(infant.model, data, jacobian, None, infant.model.body("left_hand").id)
    return np.asarray(pull_n @ jacobian[:, infant.dofs], np.float64)


def _knuckles(infant: TrialInfant) -> str:
    """Return the body that begins at the knuckles, in hands of any kind."""
    return next(name for name in ("left_fingers", "left_mfknuckle", "left_hand") if infant.has(name))


def _highest(infant: TrialInfant, resting: mujoco.MjData, places: list[int]) -> FloatArray:
    low, high = np.array([infant.model.joint(f"robot:left_{name}").range for name in JOINTS]).T
    random = np.random.default_rng(SEED)
    posture = mujoco.MjData(infant.model)
    knuckles = _knuckles(infant)
    shoulder_m = resting.body("left_upper_arm").xpos.copy()
    rest = resting.qpos[places]
    best, best_score = rest, -np.inf
    for _ in range(SAMPLES):
        angles = random.uniform(low, high)
        angles[-1] = min(high[-1], MIN_BENT_RAD)
        posture.qpos[:] = resting.qpos
        posture.qpos[places] = angles
        mujoco.mj_kinematics(infant.model, posture)
        away_m = posture.body(knuckles).xpos - shoulder_m
        score = away_m[2] - SIDEWAYS * np.abs(away_m[:2]).sum() - TRAVEL * np.abs(angles - rest).sum()
        if score > best_score:
            best, best_score = angles, score
    return best


def _targets(infant: TrialInfant, resting: mujoco.MjData, places: list[int]) -> Callable[[float], FloatArray]:
    up = _highest(infant, resting, places)
    rest = resting.qpos[places]
    bent, lifted = rest.copy(), up.copy()
    bent[-1] = lifted[-1] = BENT_RAD
    keys = []
    for arm in (rest, bent, lifted, up, up):
        whole = resting.qpos.copy()
        whole[places] = arm
        keys.append(whole[infant.angles])

    def target(time_s: float) -> FloatArray:
        leg = min(int(np.searchsorted(TIMES_S, time_s, "left")), len(TIMES_S) - 1) or 1
        share = (time_s - TIMES_S[leg - 1]) / (TIMES_S[leg] - TIMES_S[leg - 1])
        return keys[leg - 1] + share**2 * (3 - 2 * share) * (keys[leg] - keys[leg - 1])

    return target


def _measure_pulled(subject: Subject) -> Values:
    free = arm_lift(subject.infant)
    pulled = arm_lift(subject.infant, PULL)
    return {"arm_pulled": pulled, "arm_pull_change": pulled / free - 1.0 if free > 0 else None}


ARM_LIFT = MovementTrial(
    "arm_lift",
    "on its back, brings a hand above the shoulder and keeps it there for 1 s: height in arm lengths",
    lambda subject: {"arm_lift": arm_lift(subject.infant)},
    (0.0, 1.0, 2.0, 3.0, 4.0),
    (Quantity("arm_lift", "Hand above shoulder, in arm lengths"),),
    ("left_upper_arm", "left_lower_arm", "left_hand"),
    side="left",
)
ARM_PULL = MovementTrial(
    "arm_pull",
    "on its back, brings a hand above the shoulder against a pull towards the toes of a quarter of the arm's weight",
    _measure_pulled,
    (0.0,),
    (
        Quantity("arm_pulled", "Hand above shoulder against a pull, in arm lengths"),
        Quantity("arm_pull_change", "Hand above shoulder: change by the pull"),
    ),
    ("left_upper_arm", "left_lower_arm", "left_hand"),
    held_out=True,
    side="left",
)


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
REACHED_M, REACH_SETTLING_S = 0.01, 0.15  # How far from its goal the hand may be, and how long after the planned end.
LAP_ABOVE_M = 0.2


@dataclass(frozen=True, slots=True)
class Reach:
    """The result of a reach."""

    miss_m: float  # Distance of the hand from its goal at the end.
    peak_m_s: float  # Greatest speed of the hand.
    way_m: float  # Distance of the goal from where the hand began.


def reach(infant: TrialInfant, planned_s: float) -> Reach:
    """Return what comes of a reach by a target of least jerk, which the controller of the milestones follows."""
    held = infant.fixed([*infant.trunk_dofs(), *infant.dofs_of("head")])
    data = held.placed(0.0, SITTING_DEG, LAP_ABOVE_M)
    hand = held.model.body("right_hand").id
    start, end = held.turned(data, {}), held.turned(data, AHEAD_DEG)
    arrived = mujoco.MjData(held.model)
    arrived.qpos[:] = data.qpos
    arrived.qpos[held.angles] = end
    mujoco.mj_kinematics(held.model, arrived)
    goal_m = arrived.xpos[hand].copy()
    step_s = held.model.opt.timestep
    control = Controller(held, servo(held, data), step_s)
    trace = [data.xpos[hand].copy()]
    for step in range(round((planned_s + REACH_SETTLING_S) / step_s)):
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


def _measure_reach(subject: Subject) -> Values:
    shortest = fastest_reach(subject.infant)
    if shortest is None:
        return {"reach_s": None, "reach_peak_m_s": None, "reach_way_cm": None}
    planned_s, best = shortest
    return {"reach_s": planned_s, "reach_peak_m_s": best.peak_m_s, "reach_way_cm": 100 * best.way_m}


REACH = MovementTrial(
    "reach",
    "sitting with its trunk held, brings a hand from its lap to straight ahead within 1 cm, as fast as it can",
    _measure_reach,
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
    dof = int(held.model.joint(f"robot:{EYE}").dofadr[0])
    step_s = held.model.opt.timestep
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
