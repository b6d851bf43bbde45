"""Postures on the back, at rest, awake or folded, how fast awake infants move, and how slack joints recoil and swing.

About a posture in which it hangs, a slack joint obeys I q'' + c q' + (k + w) q = 0, with the inertia I of all that it
moves and its armature, its damping c, its stiffness k and the moment w of what hangs on it. Its damping ratio is
zeta = c / (2 sqrt((k + w) I)); each half swing is smaller than the one before by exp(-pi zeta / sqrt(1 - zeta²)).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2
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
    run,
    settled,
)

SETTLING_S = 4.0
FOLDING_S = 3.0
READ_STEPS = 50  # Physics steps at the end over which a folded leg is averaged.
KNEES = (0.0, -0.15, -0.3, -0.6, -1.0)
"""Shares of the knees' flexors that are tried while the hips bend with all strength."""
SIDES = ("left", "right")
RESTING = {"hip": "left_hip1", "knee": "left_knee", "elbow": "left_elbow"}
LEGS = ("left_upper_leg", "right_upper_leg", "left_toes", "right_toes", "left_upper_arm", "right_upper_arm")


def leg_length(data: mujoco.MjData, dimensions: int = 2) -> float:
    """Return the distance from hip to toes as seen from above, mean of both legs, by the length of the trunk.

    The trunk is from the middle of the shoulders to that of the hips, as seen from above too: so it is measured on
    recordings of real infants. In three *dimensions*, a leg that points up is as long as one that lies.
    """

    def seen(body: str) -> FloatArray:
        return np.asarray(data.body(body).xpos[:dimensions], np.float64)

    neck = (seen("left_upper_arm") + seen("right_upper_arm")) / 2
    hips = (seen("left_upper_leg") + seen("right_upper_leg")) / 2
    legs = [float(np.linalg.norm(seen(f"{side}_toes") - seen(f"{side}_upper_leg"))) for side in SIDES]
    return float(np.mean(legs) / np.linalg.norm(neck - hips))


def _rest(subject: Subject) -> Values:
    infant = subject.infant
    data = settled(infant, SETTLING_S)
    angles = {f"rest_{name}_deg": angle_deg(infant, data, joint) for name, joint in RESTING.items()}
    return {**angles, "rest_leg": leg_length(data)}


def _fold(subject: Subject) -> Values:
    infant = subject.infant
    start = settled(subject.infant, SETTLING_S)
    seen, true = zip(*(_folded(infant, start, knee) for knee in KNEES), strict=True)
    return {"fold_leg": min(seen), "fold_space": min(true)}


def _folded(infant: TrialInfant, start: mujoco.MjData, knee: float) -> tuple[float, float]:
    """Return how long legs are, from above and in space, after hips bent with all strength, knees with a share."""
    data = again(infant, start)
    shares = {f"{side}_hip1": -1.0 for side in SIDES} | {f"{side}_knee": knee for side in SIDES}
    lengths = [(leg_length(data), leg_length(data, 3)) for _ in driven(infant, data, FOLDING_S, shares)]
    seen, true = np.mean(lengths[-READ_STEPS:], axis=0)
    return float(seen), float(true)


HIP_DRIVE, KNEE_DRIVE = -0.25, -0.15
"""What an awake infant of 0 to 7 months bends its legs with, by their strength: behaviour, not body. Fitted to the
posture of recorded infants, which the trial compares with."""
NOISE, CORRELATED_S = 0.3, 0.3  # Size, by strength, and correlation time of the random commands of all joints; a guess.
AWAKE_S, SETTLING_AWAKE_S = 20.0, 2.0
SEED = 1
EVERY = 20  # Physics steps between two looks at the legs.


def awake(infant: TrialInfant) -> Iterator[mujoco.MjData]:
    """Yield the state of an infant that lies awake and moves at random, after each physics step."""
    data = settled(infant, SETTLING_AWAKE_S)
    drive = Drive(infant)
    step_s = infant.model.opt.timestep
    names = infant.joint_names
    steady = np.array(
        [HIP_DRIVE if name.endswith("_hip1") else KNEE_DRIVE if name.endswith("_knee") else 0.0 for name in names]
    )
    random, noise = np.random.default_rng(SEED), np.zeros(len(names))
    for _ in range(round(AWAKE_S / step_s)):
        noise += -noise * step_s / CORRELATED_S
        noise += NOISE * np.sqrt(2 * step_s / CORRELATED_S) * random.standard_normal(len(names))
        data.ctrl[:] = drive.controls(data, np.clip(steady + noise, -1.0, 1.0))
        mujoco.mj_step(infant.model, data)
        yield data


def _awake(subject: Subject) -> Values:
    lengths = [leg_length(data) for step, data in enumerate(awake(subject.infant)) if step % EVERY == 0]
    return {"awake_leg": float(np.median(lengths))}


REST = MovementTrial(
    "rest",
    "on its back, quiet as in sleep: where its joints come to rest",
    _rest,
    (0.0, 1.0, 3.0, 6.0),
    (
        *(Quantity(f"rest_{name}_deg", f"At rest: {name}", "deg") for name in RESTING),
        Quantity("rest_leg", "At rest: leg by trunk"),
    ),
    (*LEGS, "left_lower_arm"),
    side="left",
)
AWAKE = MovementTrial(
    "awake",
    "on its back, awake: bends its legs a little, and moves at random",
    _awake,
    (0.0, 1.0, 3.0, 6.0),
    (Quantity("awake_leg", "Awake: leg by trunk"),),
    LEGS,
)
FOLD = MovementTrial(
    "fold",
    "on its back, folds its legs with all strength",
    _fold,
    (0.0, 1.0, 3.0, 6.0),
    (Quantity("fold_leg", "Folded: leg by trunk"), Quantity("fold_space", "Folded: leg by trunk, in space")),
    LEGS,
)

FRAMES_HZ = 30.0  # Rate of the recordings of real infants; taken, as it is not given.
ENDS = {"hand": "hand", "foot": "toes"}
"""The bodies that begin at the points that are seen: the wrist for the hand, and the roots of the toes."""
POINTS = tuple(f"{side}_{body}" for body in ENDS.values() for side in SIDES)
PERCENTILE = 95


def places(data: mujoco.MjData) -> FloatArray:
    """Return where both hands and both feet are as seen from above, by the length of the trunk, shape (4, 2).

    The origin is the middle of the hips and the first axis points from there to the middle of the shoulders, so that
    way and turns of the trunk do not count.
    """

    def middle(body: str) -> FloatArray:
        return np.mean([data.body(f"{side}_{body}").xpos[:2] for side in SIDES], axis=0)

    hips = middle("upper_leg")
    up = middle("upper_arm") - middle("upper_leg")
    axes = np.array([up, (-up[1], up[0])]) / (up @ up)
    return np.array([axes @ (data.body(point).xpos[:2] - hips) for point in POINTS])


def speeds(trace: FloatArray, step_s: float) -> FloatArray:
    """Return the speeds of points by the central differences of a recording, shape (frames - 2, points).

    Their places after each physics step have the shape (steps, points, 2).
    """
    count, points, _ = trace.shape
    times_s = np.arange(0.0, (count - 1) * step_s, 1 / FRAMES_HZ)
    flat = trace.reshape(count, -1)
    frames = np.array([np.interp(times_s, np.arange(count) * step_s, column) for column in flat.T]).T
    velocities = (frames[2:] - frames[:-2]).reshape(-1, points, 2) * FRAMES_HZ / 2
    return np.asarray(np.linalg.norm(velocities, axis=2), np.float64)


def _speeds(subject: Subject) -> Values:
    trace = np.array([places(data) for data in awake(subject.infant)])
    seen = speeds(trace, subject.infant.model.opt.timestep)
    hands, feet = (float(np.percentile(part, PERCENTILE)) for part in (seen[:, :2], seen[:, 2:]))
    return {"speed_hand": hands, "speed_foot": feet}


SPEEDS = MovementTrial(
    "speeds",
    "awake on its back, moves at random: 95th percentile of the speeds of hands and feet, in trunk lengths a second",
    _speeds,
    (0.0, 1.0, 3.0, 6.0),
    tuple(Quantity(f"speed_{name}", f"Awake: speed of the {name}, in trunk lengths", "1/s") for name in ENDS),
    (*POINTS, "left_upper_leg", "right_upper_leg", "left_upper_arm", "right_upper_arm"),
    held_out=True,
)

STRETCHED_S = 2.0  # How long the elbow is held stretched.
WAITED_S = 2.0  # Time after which the angle is read.
ELBOW = "left_elbow"


def _recoil(subject: Subject) -> Values:
    infant, start = subject.infant, settled(subject.infant)
    model = infant.model
    holding = infant.fixed([int(model.joint(f"robot:{ELBOW}").dofadr[0])])
    held = again(holding, start, moving=False)
    held.qpos[model.joint(f"robot:{ELBOW}").qposadr[0]] = model.joint(f"robot:{ELBOW}").range[1]
    mujoco.mj_forward(holding.model, held)
    run(holding, held, STRETCHED_S, QUIET)
    stretched_deg = angle_deg(infant, held, ELBOW)
    free = again(infant, held, moving=False)
    run(infant, free, WAITED_S, QUIET)
    return {"recoil_deg": stretched_deg - angle_deg(infant, free, ELBOW)}


RECOIL = MovementTrial(
    "recoil",
    "on its back and quiet, an elbow is held stretched for 2 s and let go: how far it has bent after 2 s",
    _recoil,
    (0.0, 1.0, 3.0, 6.0, 9.0),
    (Quantity("recoil_deg", "Recoil of the elbow", "deg"),),
    ("left_lower_arm",),
    side="left",
)


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
    hinge = model.joint(f"robot:{joint}").id
    dof = int(model.joint(f"robot:{joint}").dofadr[0])
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
