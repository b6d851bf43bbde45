"""Torque actuation: the command is a share of each motor's gear."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.actuation.commands import Commands, command_range, find_actuators, limits_of_motors, mean_effort
from mimoc.actuation.spec import ActuationEntry


@dataclass(frozen=True)
class Torque(Commands):
    """Commands in [-1, 1]; torque = gear x command, within the motor's force range."""

    def effort(self, data: mujoco.MjData) -> float:
        """Return what the torques of the last physics step cost; see `mean_effort`."""
        return mean_effort(data.actuator_force[self.actuators], np.abs(self.limits_nm).max(axis=1))


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Torque:
    """Find the actuators of *entry* in *model*."""
    ids = find_actuators(entry, model)
    return Torque(ids, *command_range(entry), limits_of_motors(model, ids))
