"""Conversion of desired joint torques to an action: of motors, or of muscles in pairs of antagonists."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import ControlError
from mimoc.base.mujoco_layout import TIME_CONSTANT
from mimoc.runtime.actuation import Actuation
from mimoc.runtime.sense import FloatArray, IntArray


class Activation:
    """The activations of some actuators, which approach their commands exponentially (MuJoCo's `filterexact`).

    An actuator without an activation is driven by its command at once.
    """

    def __init__(self, model: mujoco.MjModel, actuators: IntArray, step_s: float):
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


class TorqueMapping(ABC):
    """Converts torques of n joints to an action."""

    def __init__(self, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float):
        """Find the actuators of joints, shape (n,); torques are reached at the end of a control step of *step_s*."""
        driven = model.actuator_trnid[actuation.actuators, 0]
        self._slots = self._find(driven == joints[:, None], model.actuator_gear[actuation.actuators, 0])
        self._at_rest = np.clip(0.0, actuation.low, actuation.high)
        self._all, self._actuators = actuation.actuators, actuation.actuators[self._slots]
        self._low, self._high = actuation.low[self._slots], actuation.high[self._slots]
        self._gears_nm = model.actuator_gear[self._actuators, 0]
        self._limits_nm = limits_nm = actuation.limits_nm[self._slots]
        self._activation = Activation(model, self._actuators, step_s)
        self.strength_nm: FloatArray = np.abs(limits_nm).max(axis=tuple(range(1, limits_nm.ndim)))
        """Largest torque of each joint, shape (n,)."""

    @abstractmethod
    def _find(self, drives: npt.NDArray[np.bool_], gears_nm: FloatArray) -> IntArray:
        """Return the places of each joint's actuators in the action, of which a row of *drives* says which they are."""

    @abstractmethod
    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the joints' actuators to rest and update `data.qfrc_actuator`; others keep their activation.

        Returns:
            Smallest and largest torque that they could add in this state, shape (n, 2), [N m].
        """

    @abstractmethod
    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds torques within their limits, shape (n,), to those at rest.

        The activation that gives them is reached at the end of the control step, if a command can achieve that.
        """

    def _action(self, activations: FloatArray) -> FloatArray:
        """Return the action that brings the actuators to activations as far as it can; all others rest."""
        action = self._at_rest.copy()
        action[self._slots] = np.clip(self._activation.commands(activations), self._low, self._high)
        return action


LEAST_NM = 1e-12  # Torque below which a muscle counts as not pulling, as when it shortens too fast.


class Antagonists(TorqueMapping):
    """Two muscles per joint, of which one produces the torque, within its force-length-velocity limits, and one rests.

    A muscle's force is gain x activation + bias; MuJoCo's forces at full and at zero activation determine both.
    """

    def _find(self, drives: npt.NDArray[np.bool_], gears_nm: FloatArray) -> IntArray:
        return np.stack([(drives & (-gears_nm * way > 0)).argmax(axis=1) for way in (-1, 1)], axis=1)

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the muscles to rest and return their torques at full activation; see `TorqueMapping`."""
        self._activation.keep(data)
        self._activation.set(data, 1.0)
        mujoco.mj_fwdActuation(model, data)
        full_n = data.actuator_force[self._actuators]
        self._activation.set(data, 0.0)
        mujoco.mj_fwdActuation(model, data)
        self._pulls_nm = self._gears_nm * (full_n - data.actuator_force[self._actuators])
        return self._pulls_nm

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action in which the muscle that pulls the right way is active; see `TorqueMapping`."""
        pulling = np.abs(self._pulls_nm) > LEAST_NM
        needed = np.divide(torques_nm[:, None], self._pulls_nm, out=np.zeros_like(self._pulls_nm), where=pulling)
        return self._action(np.clip(needed, 0.0, 1.0))


class Motors(TorqueMapping):
    """One motor per joint, whose torque is gear x command, or gear x activation."""

    def _find(self, drives: npt.NDArray[np.bool_], gears_nm: FloatArray) -> IntArray:
        return drives.argmax(axis=1)

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the motors to rest and return their limits; see `TorqueMapping`."""
        self._activation.keep(data)
        self._activation.set(data, 0.0)
        data.ctrl[self._all] = self._at_rest
        mujoco.mj_fwdActuation(model, data)
        return self._limits_nm

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action of these shares of the gears; see `TorqueMapping`."""
        shares = np.divide(torques_nm, self._gears_nm, out=np.zeros(len(torques_nm)), where=self._gears_nm != 0)
        return self._action(shares)


TORQUE_MAPPINGS: Mapping[str, type[TorqueMapping]] = {"torque": Motors, "muscle": Antagonists}
"""Torque mapping by actuation model. Servos have none, because their commands are angles and not torques."""


def find_mapping(model_name: str) -> type[TorqueMapping]:
    """Return the torque mapping of an actuation model; ControlError if it cannot produce given torques."""
    if model_name not in TORQUE_MAPPINGS:
        others = " or ".join(f"{{model: {other}}}" for other in TORQUE_MAPPINGS)
        raise ControlError(
            f"inverse dynamics computes torques, which the actuation model '{model_name}' does not accept; build the "
            f"infant with actuation: {others}"
        )
    return TORQUE_MAPPINGS[model_name]
