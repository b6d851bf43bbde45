"""Position actuation: the command is the angle that each servo goes to."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.runtime.actuation.commands import Commands, command_range, find_actuators
from mimoc.schema.manifest import ActuationEntry


@dataclass(frozen=True)
class Position(Commands):
    """Commands in [-1, 1]; from one end of the joint's range to the other."""

    def effort(self, data: mujoco.MjData) -> float:
        """Return 0: servos have no strength that they could use a part of."""
        return 0.0


def bind_position(entry: ActuationEntry, model: mujoco.MjModel) -> Position:
    """Find the servos of *entry* in *model*."""
    ids = find_actuators(entry, model)
    return Position(ids, *command_range(entry), np.tile([-np.inf, np.inf], (len(ids), 1)))
