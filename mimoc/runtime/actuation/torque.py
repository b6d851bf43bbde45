"""Torque actuation: the command is a share of each motor's gear."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.runtime.senses.sense import FloatArray, IntArray
from mimoc.schema.manifest import ActuationEntry


@dataclass(frozen=True)
class Torque:
    """Commands in [-1, 1], shape (n,); torque = gear x command, within the motor's force range."""

    actuators: IntArray
    low: FloatArray
    high: FloatArray

    def __call__(self, action: np.ndarray, data: mujoco.MjData) -> None:
        """Set the controls; MuJoCo clips them to their range.

        Raises:
            ValueError: If the action is not one number for each actuator.
        """
        if np.shape(action) != self.low.shape or np.isnan(action).any():
            raise ValueError(f"an action is {len(self.low)} numbers, one for each actuator, and none of them NaN")
        data.ctrl[self.actuators] = action


def bind_torque(entry: ActuationEntry, model: mujoco.MjModel) -> Torque:
    """Find the actuators of *entry* in *model*."""
    return Torque(
        actuators=np.array([model.actuator(actuator.name).id for actuator in entry.actuators]),
        low=np.array([actuator.action_low for actuator in entry.actuators]),
        high=np.array([actuator.action_high for actuator in entry.actuators]),
    )
