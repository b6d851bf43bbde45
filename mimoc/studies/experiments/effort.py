"""Strength: maximum-effort movements of single joints, and torques by the gravity moments that they work against."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.body.poses import Pose, resting_state
from mimoc.compiler import building
from mimoc.compiler.building import Builder
from mimoc.compiler.measuring import compile_infant
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiments.child import child

Model = Literal["torque", "muscle"]

STEP_MS = 5.0  # Duration of both control and physics steps, as in the paper.
STEPS = 500
SETTLING_STEPS = 400
FLAT = Pose(pitch_deg=-90, angles_deg={}, relaxed=False)  # Lying on the back, all joints at zero.


@dataclass(frozen=True, slots=True)
class Behaviour:
    """A movement of one joint."""

    name: str
    actuator: str  # Name of the actuator in MIMo.
    joint: str
    direction: int  # 1 towards positive joint angles, -1 towards negative ones.


BEHAVIOURS = (
    Behaviour("head lift", "act:head_tilt", "robot:head_tilt", 1),
    Behaviour("leg lift", "act:right_hip_flex", "robot:right_hip1", -1),
)


@dataclass(frozen=True, slots=True)
class Effort:
    """The trajectory of a joint; angles are measured from the joint's zero, positive in the behaviour's direction."""

    behaviour: Behaviour
    age_months: float
    strength_age_months: float
    length_cm: float  # Length of the infant from crown to sole.
    angle_deg: FloatArray  # Angles at the start and after each control step, shape (n + 1,).
    end_deg: float  # Limit of the joint range, which is soft.

    @property
    def time_s(self) -> FloatArray:
        """Times of the angles, shape (n + 1,)."""
        return np.arange(len(self.angle_deg), dtype=np.float64) * ms_to_s(STEP_MS)

    @property
    def peak_deg(self) -> float:
        """The largest angle; a fast joint exceeds its soft limit slightly."""
        return float(self.angle_deg.max())

    @property
    def peak_in_range_deg(self) -> float:
        """The largest angle, clipped to the joint range."""
        return min(self.peak_deg, self.end_deg)

    def time_to_s(self, angle_deg: float) -> float | None:
        """Return the time at which an angle was first reached, interpolated between steps; None if it never was."""
        reached = np.flatnonzero(self.angle_deg >= angle_deg)
        if not reached.size:
            return None
        around = slice(max(reached[0] - 1, 0), reached[0] + 1)
        return float(np.interp(angle_deg, self.angle_deg[around], self.time_s[around]))


def efforts(
    development: Development, age_months: float, model: Model = "torque", strength_age_months: float | None = None
) -> Iterator[Effort]:
    """Yield the trajectory of each behaviour of the average child, all from the same resting state.

    Its strength is that of another age if `strength_age_months` says so.
    """
    builder = lying(development, age_months, model, strength_age_months)
    with closing(InfantEnv(builder(0, check=False))) as env:
        env.reset()
        env.data.qpos[:] = resting_state(builder.tree, FLAT)
        nothing = np.zeros(len(env.manifest.actuation.actuators), np.float32)
        for _ in range(SETTLING_STEPS):
            env.step(nothing)
        rest = env.get_state()
        for behaviour in BEHAVIOURS:
            env.set_state(rest)
            yield _effort(env, behaviour, age_months if strength_age_months is None else strength_age_months)


def lying(
    development: Development, age_months: float, model: Model = "torque", strength_age_months: float | None = None
) -> Builder:
    """Return the builder of the infant; for its arguments see `efforts`."""
    actuation = {"model": model, "strength_age_months": strength_age_months}
    control = {"step_ms": STEP_MS, "timestep_ms": STEP_MS}
    return building.builder(child("lying", age_months, development=development, actuation=actuation, control=control))


def _effort(env: InfantEnv, behaviour: Behaviour, strength_age_months: float) -> Effort:
    joint = env.model.joint(behaviour.joint)
    muscle = f"{behaviour.actuator}_{'positive' if behaviour.direction > 0 else 'negative'}"
    wanted = {behaviour.actuator: behaviour.direction, muscle: 1}
    actuators = env.manifest.actuation.actuators
    action = np.array([wanted.get(actuator.name, 0) for actuator in actuators], np.float32)
    angles_rad = [float(env.data.qpos[joint.qposadr[0]])]
    for _ in range(STEPS):
        env.step(action)
        angles_rad.append(float(env.data.qpos[joint.qposadr[0]]))
    return Effort(
        behaviour=behaviour,
        age_months=env.manifest.child.age_months,
        strength_age_months=strength_age_months,
        length_cm=env.manifest.child.length_cm,
        angle_deg=behaviour.direction * np.degrees(angles_rad),
        end_deg=float(np.degrees((behaviour.direction * joint.range).max())),
    )


GROUPS = {  # The motor and the direction that stand for each group of muscles.
    "neck, back": ("act:head_tilt", -1),
    "neck, front": ("act:head_tilt", 1),
    "trunk": ("act:hip_bend", 1),
    "arm": ("act:right_shoulder_abduction", 1),
    "hand": ("act:right_wrist_flexion", 1),
    "hip": ("act:right_hip_flex", -1),
    "knee": ("act:right_knee", 1),
    "ankle": ("act:right_foot_flexion", -1),
}


@dataclass(frozen=True, slots=True)
class Strength:
    """What one motor can do in one direction."""

    development: Development
    age_months: float
    actuator: str
    direction: int  # 1 towards positive joint angles, -1 towards negative ones.
    torque_nm: float  # Largest torque.
    moment_nm: float  # Gravity moment of all that hangs on the joint, stretched out level.

    @property
    def ratio(self) -> float:
        """Torque by gravity moment: below 1, the infant cannot lift it."""
        return self.torque_nm / self.moment_nm


def strengths(development: Development, age_months: float) -> Iterator[Strength]:
    """Yield the strength of all motors of the average child, but for those of the eyes, in both directions."""
    spec = InfantSpec(mimoc=1, name="standing", age_months=age_months, development=development)
    model = compile_infant(spec)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for actuator in range(model.nu):
        name = model.actuator(actuator).name
        joint = int(model.actuator_trnid[actuator, 0])
        if "eye" in name:
            continue
        for direction, limit in zip((-1, 1), model.actuator_forcerange[actuator], strict=True):
            torque_nm = abs(model.actuator_gear[actuator, 0] * limit)
            yield Strength(development, age_months, name, direction, float(torque_nm), _moment_nm(model, data, joint))


def _moment_nm(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> float:
    """Return the weight of what hangs on a hinge, times the distance of its centre of mass from the hinge."""
    body = int(model.jnt_bodyid[joint])
    arm_m = np.linalg.norm(data.subtree_com[body] - data.xanchor[joint])
    return float(GRAVITY_M_S2 * model.body_subtreemass[body] * arm_m)
