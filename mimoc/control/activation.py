"""Activation: the commands with which actuators reach wanted activations by the end of a control step."""

import mujoco
import numpy as np

from mimoc.mujoco_layout import TIME_CONSTANT
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
