"""Sums of squared commands on a device; see `mimoc.tasks.task.SquaredCommands`."""

from collections.abc import Sequence

import numpy as np
import warp as wp

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put


def command_bounds(infants: Sequence[InfantEnv]) -> wp.array:
    """Return the least and the largest command of each body and actuator, shape (bodies, n)."""
    return put([np.stack([each.actuation.low, each.actuation.high], 1) for each in infants], wp.vec2)


@wp.func
def squared_commands(actions: wp.array2d[float], bounds: wp.array2d[wp.vec2], body: int, world: int) -> float:
    """Return the sum of the squared commands of a world, which are clipped to their ranges first."""
    total = float(0.0)
    for number in range(actions.shape[1]):
        limits = bounds[body, number]
        command = wp.clamp(actions[world, number], limits[0], limits[1])
        total += command * command
    return total
