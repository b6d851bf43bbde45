"""The torque of each motor by the gravity moment of what it moves, by age and law."""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.compiler.validation.requests import compile_infant
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.milestones.infant import GRAVITY_M_S2

GROUPS = {
    "neck, back": ("act:head_tilt", -1),
    "neck, front": ("act:head_tilt", 1),
    "trunk": ("act:hip_bend", 1),
    "arm": ("act:right_shoulder_abduction", 1),
    "hand": ("act:right_wrist_flexion", 1),
    "hip": ("act:right_hip_flex", -1),
    "knee": ("act:right_knee", 1),
    "ankle": ("act:right_foot_flexion", -1),
}
"""The motor and the direction that stand for each group of muscles."""


@dataclass(frozen=True, slots=True)
class Strength:
    """What one motor can do in one direction."""

    development: Development
    age_months: float
    actuator: str
    direction: int
    """1 towards positive joint angles, -1 towards negative ones."""
    torque_nm: float
    """Largest torque."""
    moment_nm: float
    """Gravity moment of all that hangs on the joint, stretched out level."""

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
