"""Conversion of desired joint torques to an action: of motors, or of muscles in pairs of antagonists."""

from collections.abc import Callable, Mapping
from typing import Protocol

import mujoco
import numpy as np

from mimoc.actuation.binding import Actuation
from mimoc.base.errors import ControlError
from mimoc.base.mujoco_layout import TIME_CONSTANT
from mimoc.senses.sense import FloatArray, IntArray


class Activation:
    """The activations of some actuators, which approach their commands exponentially (MuJoCo's `filterexact`).

    An actuator without an activation is driven by its command at once.
    """

    def __init__(self, model: mujoco.MjModel, actuators: IntArray, step_s: float):
        """Find the activations.

        Args:
            model: The model.
            actuators: Index of each actuator, of any shape.
            step_s: Duration of a control step.
        """
        addresses = model.actuator_actadr[actuators]
        self._has_one = addresses >= 0
        self._addresses = addresses[self._has_one]
        self._present = np.zeros(np.shape(actuators))
        self._approached = np.ones(np.shape(actuators))
        time_constants_s = model.actuator_dynprm[actuators, TIME_CONSTANT][self._has_one]
        self._approached[self._has_one] = 1.0 - np.exp(-step_s / time_constants_s)

    def keep(self, data: mujoco.MjData) -> None:
        """Remember the present activations."""
        self._present[self._has_one] = data.act[self._addresses]

    def set(self, data: mujoco.MjData, level: float) -> None:
        """Set the activations to a level."""
        data.act[self._addresses] = level

    def commands(self, wanted: FloatArray) -> FloatArray:
        """Return the commands that bring activations from those that were kept to wanted ones in one control step."""
        return self._present + (wanted - self._present) / self._approached


LEAST_NM = 1e-12
"""Torque below which a muscle counts as not pulling, as when it shortens too fast."""


class Antagonists:
    """Two muscles per joint, of which one produces the torque, within its force-length-velocity limits, and one rests.

    A muscle's force is gain x activation + bias; MuJoCo's forces at full and at zero activation determine both.
    """

    def __init__(self, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float):
        """Find the muscles of n joints.

        Args:
            actuation: Conversion of actions to controls.
            joints: Index of each joint, shape (n,).
            model: The model.
            step_s: Duration of a control step, at whose end the torques are to be reached.
        """
        driven = model.actuator_trnid[actuation.actuators, 0]
        gears = model.actuator_gear[actuation.actuators, 0]
        slots = [[_slot((driven == joint) & (-gears * way > 0)) for way in (-1, 1)] for joint in joints]
        self._slots = np.array(slots, np.intp).reshape(-1, 2)
        self._at_rest = np.clip(0.0, actuation.low, actuation.high)
        self._muscles = actuation.actuators[self._slots]
        self._gears = gears[self._slots]
        self._activation = Activation(model, self._muscles, step_s)
        self._strength_nm = np.abs(actuation.limits_nm[self._slots]).max(axis=(1, 2))
        self._pulls_nm = np.zeros(self._slots.shape)

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint at its muscles' best length, shape (n,)."""
        return self._strength_nm

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the joints' muscles to rest and update `data.qfrc_actuator`; other muscles keep their activation.

        Returns:
            Smallest and largest torque that they could add in this state, shape (n, 2), [N m].
        """
        self._activation.keep(data)
        self._activation.set(data, 1.0)
        mujoco.mj_fwdActuation(model, data)
        full_n = data.actuator_force[self._muscles]
        self._activation.set(data, 0.0)
        mujoco.mj_fwdActuation(model, data)
        self._pulls_nm = self._gears * (full_n - data.actuator_force[self._muscles])
        return self._pulls_nm

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds torques, shape (n,), to those at rest.

        The required activation is reached at the end of the control step, if a command in [0, 1] can achieve that.
        """
        pulling = np.abs(self._pulls_nm) > LEAST_NM
        needed = np.divide(torques_nm[:, None], self._pulls_nm, out=np.zeros_like(self._pulls_nm), where=pulling)
        needed = np.clip(needed, 0.0, 1.0)
        action = self._at_rest.copy()
        action[self._slots] = np.clip(self._activation.commands(needed), 0.0, 1.0)
        return action


def _slot(slots: np.ndarray) -> int:
    """Return the only index of the action at which *slots*, shape (nu,), is true."""
    return int(np.flatnonzero(slots)[0])


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
