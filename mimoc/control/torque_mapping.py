"""Conversion of desired joint torques to an action, by actuation model."""

from collections.abc import Callable, Mapping
from typing import Protocol

import mujoco
import numpy as np

from mimoc.actuation.binding import Actuation
from mimoc.control.activation import Activation
from mimoc.control.antagonists import Antagonists
from mimoc.errors import ControlError
from mimoc.senses.sense import FloatArray, IntArray


class Motors:
    """One motor per joint, whose torque is gear x command, or gear x activation."""

    def __init__(self, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float):
        """Find the motors of n joints.

        Args:
            actuation: Conversion of actions to controls.
            joints: Index of each joint, shape (n,).
            model: The model.
            step_s: Duration of a control step, at whose end the torques are to be reached.
        """
        driven = model.actuator_trnid[actuation.actuators, 0]
        self._slots = np.array([np.flatnonzero(driven == joint)[0] for joint in joints], np.intp)
        self._at_rest = np.clip(0.0, actuation.low, actuation.high)
        self._actuators = actuation.actuators
        self._gears_nm = model.actuator_gear[self._actuators[self._slots], 0]
        self._limits_nm = actuation.limits_nm[self._slots]
        self._low, self._high = actuation.low[self._slots], actuation.high[self._slots]
        self._activation = Activation(model, self._actuators[self._slots], step_s)

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint, shape (n,)."""
        return np.abs(self._limits_nm).max(axis=1)

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the joints' motors to rest and update `data.qfrc_actuator`; other motors keep their activation.

        Returns:
            Smallest and largest torque that each joint's motor could add, shape (n, 2), [N m].
        """
        self._activation.keep(data)
        self._activation.set(data, 0.0)
        data.ctrl[self._actuators] = self._at_rest
        mujoco.mj_fwdActuation(model, data)
        return self._limits_nm

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds torques within their limits, shape (n,), to those at rest.

        The activation that gives them is reached at the end of the control step, if a command in [-1, 1] can do that.
        """
        shares = np.divide(torques_nm, self._gears_nm, out=np.zeros(len(torques_nm)), where=self._gears_nm != 0)
        action = self._at_rest.copy()
        action[self._slots] = np.clip(self._activation.commands(shares), self._low, self._high)
        return action


class TorqueMapping(Protocol):
    """Converts torques of n joints to an action."""

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint, shape (n,)."""
        ...

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the joints' actuators to rest and update `data.qfrc_actuator`.

        Returns:
            Smallest and largest torque that they could add in this state, shape (n, 2), [N m].
        """
        ...

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds torques, shape (n,), to those at rest."""
        ...


TORQUE_MAPPINGS: Mapping[str, Callable[[Actuation, IntArray, mujoco.MjModel, float], TorqueMapping]] = {
    "torque": Motors,
    "muscle": Antagonists,
}
"""Torque mapping by actuation model. Servos have none, because their commands are angles and not torques."""


def map_torques(
    model_name: str, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float
) -> TorqueMapping:
    """Return the torque mapping of an actuation model.

    Args:
        model_name: The actuation model.
        actuation: Conversion of actions to controls.
        joints: Index of each joint, shape (n,).
        model: The infant and its world.
        step_s: Duration of a control step.

    Raises:
        ControlError: If the actuation model cannot produce given torques.
    """
    if model_name not in TORQUE_MAPPINGS:
        others = " or ".join(f"{{model: {other}}}" for other in TORQUE_MAPPINGS)
        raise ControlError(
            f"inverse dynamics computes torques, which the actuation model '{model_name}' does not accept; build the "
            f"infant with actuation: {others}"
        )
    return TORQUE_MAPPINGS[model_name](actuation, joints, model, step_s)
