"""Arm lift: on its back, an infant brings a hand above the shoulder and keeps it there, also against a pull."""

from collections.abc import Callable
from itertools import pairwise

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2
from mimoc.compiler.measuring import ROOT
from mimoc.policies.control.holding.controller import Controller, servo
from mimoc.runtime.sense import FloatArray
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.drive import QUIET, Drive, again, hinges_below, settled
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

JOINTS = ("shoulder_horizontal", "shoulder_ad_ab", "shoulder_rotation", "elbow")
SAMPLES, SEED = 3000, 0  # Postures of the arm among which the one is chosen that is to be held.
BENT_RAD, LEAST_BENT_RAD = np.radians(-140.0), -0.1
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
    data, step_s = again(infant, resting, moving=False), infant.model.opt.timestep
    data.act[:] = 0.0
    gains, drive = servo(infant, data), Drive(infant)
    control, pull_n = Controller(infant, gains, step_s), pull * _pull_n(infant, resting)
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
    random, posture, knuckles = np.random.default_rng(SEED), mujoco.MjData(infant.model), _knuckles(infant)
    shoulder_m, rest = resting.body("left_upper_arm").xpos.copy(), resting.qpos[places]
    best, best_score = rest, -np.inf
    for _ in range(SAMPLES):
        angles = random.uniform(low, high)
        angles[-1] = min(high[-1], LEAST_BENT_RAD)
        posture.qpos[:] = resting.qpos
        posture.qpos[places] = angles
        mujoco.mj_kinematics(infant.model, posture)
        away_m = posture.body(knuckles).xpos - shoulder_m
        score = away_m[2] - SIDEWAYS * np.abs(away_m[:2]).sum() - TRAVEL * np.abs(angles - rest).sum()
        if score > best_score:
            best, best_score = angles, score
    return best


def _targets(infant: TrialInfant, resting: mujoco.MjData, places: list[int]) -> Callable[[float], FloatArray]:
    up, rest = _highest(infant, resting, places), resting.qpos[places]
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
    free, pulled = arm_lift(subject.infant), arm_lift(subject.infant, PULL)
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
