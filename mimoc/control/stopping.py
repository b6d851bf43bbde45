"""Joint limits: torques with which joints stop before the ends of their ranges, at the highest priority."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mimoc.control.priorities import LinearDemand, fulfil
from mimoc.senses.sense import FloatArray, IntArray

MOST_PASSES = 2
"""Number of passes: torques are computed a second time if joints would not stop in time; more passes gain nothing."""
HELD = 1e-3
"""Ratio of a joint's response with supports to that without, below which it counts as held, such as a locked joint."""
SLACK = 1e-6
"""Tolerance by which a joint may exceed a bound, relative to its response to full strength."""
LEAST_RESPONSE = 1e-9
"""Response to full strength below which a joint counts as having no strength, [rad/s²]."""


@dataclass(frozen=True, slots=True)
class Turning:
    """Accelerations of n joints as a function of their torques (fractions of strength)."""

    response: FloatArray
    """Acceleration of each joint per unit of each torque, shape (n, n), [rad/s²]."""
    drift: FloatArray
    """Acceleration without torques, shape (n,), [rad/s²]."""
    unheld: FloatArray
    """Acceleration of each joint at its own full strength without supports, shape (n,), [rad/s²]."""

    def demand(self, joints: Sequence[int] | IntArray, accelerations: FloatArray) -> LinearDemand:
        """Return a demand for accelerations of some joints, each normalised by its own response.

        Joints that are held by the world are omitted.
        """
        sizes = np.where(self.free[joints], self.unheld[joints], np.inf)
        return LinearDemand(self.response[joints] / sizes[:, None], (accelerations - self.drift[joints]) / sizes)

    @property
    def free(self) -> npt.NDArray[np.bool_]:
        """Mask of the joints that are not held by the world and have some strength, shape (n,)."""
        return self.response.diagonal() > np.maximum(HELD * self.unheld, LEAST_RESPONSE)


def fulfil_within(
    turning: Turning, least: FloatArray, largest: FloatArray, demands: Sequence[LinearDemand], rest: LinearDemand
) -> FloatArray:
    """Return the torques, shape (n,), that fulfil demands as far as all joints stay within their bounds.

    If the torques would move joints beyond their bounds, these bounds become demands of the highest priority.

    Args:
        turning: Response of the joints.
        least: Smallest allowed acceleration of each joint, shape (n,), [rad/s²].
        largest: Largest allowed acceleration of each joint, shape (n,), [rad/s²].
        demands: The demands, the most important first.
        rest: Demand of the lowest priority, for the remaining freedom.
    """
    slack = SLACK * turning.unheld
    free = turning.free
    stopping, stops = np.zeros(len(free), bool), np.zeros(len(free))
    shares = fulfil(demands, rest)
    for _ in range(MOST_PASSES - 1):
        coming = turning.response @ shares + turning.drift
        beyond = free & ~stopping & ((coming > largest + slack) | (coming < least - slack))
        if not beyond.any():
            break
        stops[beyond] = np.clip(coming, least, largest)[beyond]
        stopping |= beyond
        joints = np.flatnonzero(stopping)
        shares = fulfil([turning.demand(joints, stops[joints]), *demands], rest)
    return shares
