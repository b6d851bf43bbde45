"""Position actuation: the command is the angle that each servo goes to, as fast as its strength allows."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.actuation.commands import Commands, command_range, find_actuators, limits_of_motors, mean_effort
from mimoc.actuation.spec import ActuationEntry


@dataclass(frozen=True)
class Position(Commands):
    """Commands in [-1, 1]; from one end of the joint's range to the other."""

    def effort(self, data: mujoco.MjData) -> float:
        """Return what the torques of the last physics step cost; see `mean_effort`."""
        largest_nm = np.abs(self.limits_nm).max(axis=1)
        torques_nm = data.actuator_force[self.actuators]
        shares = np.divide(torques_nm, largest_nm, out=np.zeros(len(largest_nm)), where=largest_nm > 0)
        return mean_effort(shares, largest_nm)


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Position:
    """Find the servos of *entry* in *model*."""
    ids = find_actuators(entry, model)
    return Position(ids, *command_range(entry), limits_of_motors(model, ids))
