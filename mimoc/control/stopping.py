"""Stopping: torques with which joints stop before the ends of their ranges, whatever else is wanted of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mimoc.control.priorities import Wish, fulfil
from mimoc.senses.sense import FloatArray, IntArray

MOST_PASSES = 2
"""How often torques are worked out: a second time if joints would not stop in time. Further times gain nothing."""
HELD = 1e-3
"""Share of its response at which a joint counts as held by the world, as one that is locked."""
SLACK = 1e-6
"""How much of a joint's response to its whole strength it may pass a bound by."""
LEAST_RESPONSE = 1e-9
"""What the whole strength of a joint does that has next to none, [rad/s²]."""


@dataclass(frozen=True, slots=True)
class Turning:
    """How n joints turn with their own shares of torque."""

    response: FloatArray
    """What each share does to each joint, shape (n, n), [rad/s²]."""
    drift: FloatArray
    """What happens without, shape (n,), [rad/s²]."""
    unheld: FloatArray
    """What the whole strength of each joint would do to it if nothing held the infant, shape (n,), [rad/s²]."""

    def wish(self, joints: Sequence[int] | IntArray, accelerations: FloatArray) -> Wish:
        """Return the wish that some joints accelerate so, each by its own response, so that they all count alike.

        What is wanted of joints that the world holds is left out.
        """
        sizes = np.where(self.free[joints], self.unheld[joints], np.inf)
        return Wish(self.response[joints] / sizes[:, None], (accelerations - self.drift[joints]) / sizes)

    @property
    def free(self) -> npt.NDArray[np.bool_]:
        """Which joints the world does not hold, and which have any strength, shape (n,)."""
        return self.response.diagonal() > np.maximum(HELD * self.unheld, LEAST_RESPONSE)


def fulfil_within(
    turning: Turning, least: FloatArray, largest: FloatArray, wishes: Sequence[Wish], rest: Wish
) -> FloatArray:
    """Return the shares of torque, shape (n,), that fulfil wishes as far as no joint leaves its bounds.

    Joints that would are found by trying; to keep to their bounds is then more important than anything else.

    Args:
        turning: How the joints turn.
        least: Least acceleration of each joint, shape (n,), [rad/s²].
        largest: The largest, shape (n,).
        wishes: The most important first.
        rest: What is done with all that they leave free.
    """
    slack = SLACK * turning.unheld
    free = turning.free
    stopping, stops = np.zeros(len(free), bool), np.zeros(len(free))
    shares = fulfil(wishes, rest)
    for _ in range(MOST_PASSES - 1):
        coming = turning.response @ shares + turning.drift
        beyond = free & ~stopping & ((coming > largest + slack) | (coming < least - slack))
        if not beyond.any():
            break
        stops[beyond] = np.clip(coming, least, largest)[beyond]
        stopping |= beyond
        joints = np.flatnonzero(stopping)
        shares = fulfil([turning.wish(joints, stops[joints]), *wishes], rest)
    return shares
