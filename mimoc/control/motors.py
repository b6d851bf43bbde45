"""Motors: from desired joint torques to motor commands."""

import mujoco
import numpy as np

from mimoc.actuation.binding import Actuation
from mimoc.senses.sense import FloatArray, IntArray


class Motors:
    """One motor per joint, whose torque is gear x command."""

    def __init__(self, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float):
        """Find the motors of n joints.

        Args:
            actuation: Conversion of actions to controls.
            joints: Index of each joint, shape (n,).
            model: The model.
            step_s: Duration of a control step, which motors do not depend on.
        """
        driven = model.actuator_trnid[actuation.actuators, 0]
        self._slots = np.array([np.flatnonzero(driven == joint)[0] for joint in joints], np.intp)
        self._at_rest = np.clip(0.0, actuation.low, actuation.high)
        self._actuators = actuation.actuators
        self._gears_nm = model.actuator_gear[self._actuators[self._slots], 0]
        self._limits_nm = actuation.limits_nm[self._slots]

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint, shape (n,)."""
        return np.abs(self._limits_nm).max(axis=1)

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set all motors to rest and update `data.qfrc_actuator`.

        Returns:
            Smallest and largest torque that each joint's motor could add, shape (n, 2), [N m].
        """
        data.ctrl[self._actuators] = self._at_rest
        mujoco.mj_fwdActuation(model, data)
        return self._limits_nm

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), with torques of the joints, shape (n,), clipped to their limits."""
        action = self._at_rest.copy()
        strong = self._gears_nm != 0
        action[self._slots[strong]] = torques_nm[strong] / self._gears_nm[strong]
        return action
