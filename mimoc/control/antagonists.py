"""Antagonists: from desired joint torques to muscle commands."""

import mujoco
import numpy as np

from mimoc.actuation.binding import Actuation
from mimoc.control.activation import Activation
from mimoc.senses.sense import FloatArray, IntArray

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
