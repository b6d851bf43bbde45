"""A learner that does more of what makes the world move: gains of limbs by how their activity predicts reward."""

import numpy as np

from mimoc.senses.sense import FloatArray
from mimoc.studies.experiments.legs.driving import LIMBS

WINDOW_S = 2.0
"""Time over which reward and activity are averaged; a guess."""
RATE = 0.04
"""Share of the error that is learnt of in a window, for an activity of one standard deviation; fitted."""
EFFORT = 3.0
"""Logarithm of the gain of a limb that predicts reward fully; fitted."""
MOST = 3.0
"""Standard deviations beyond which nothing counts more."""
FORGETTING_S = 200.0
"""Time constant in which gains go back to 1; fitted."""
EXPECTING_S = 60.0
"""Time constant of the means and variances that are expected; a guess."""
LARGEST = float(np.log(4.0))
"""Of the logarithm of a gain; a guess."""
SMALLEST_REWARD = 1e-4
"""Reward below which nothing is seen to move, [m/s]."""


class Expected:
    """Running mean and variance of some numbers: the plain ones at first, later those of the last minute."""

    def __init__(self, size: int):
        """Begin without any experience of *size* numbers."""
        self._mean, self._variance, self._count = np.zeros(size), np.zeros(size), 0

    def standardised(self, values: FloatArray) -> FloatArray:
        """Return how many standard deviations values are above what was expected, shape (n,), and expect them more."""
        self._count += 1
        share = max(WINDOW_S / EXPECTING_S, 1.0 / self._count)
        surprise = values - self._mean
        deviation = np.sqrt(self._variance)
        self._mean = self._mean + share * surprise
        self._variance = (1.0 - share) * (self._variance + share * surprise**2)
        return np.divide(surprise, deviation, out=np.zeros(len(values)), where=deviation > 0.0)


class GainLearner:
    """Learns how much each limb moves the world, and drives those that do with a gain (Rescorla & Wagner 1972).

    After each window, with z the standardised activity of each limb (the mean size of its commands, before gains) and R
    the standardised reward, the strengths b by which activity predicts reward change by

        b <- (1 - window / forgetting) b + rate (R - b · z) z,

    and the gain of a limb is exp(effort b). Limbs compete: one that only moves together with another that moves the
    world predicts nothing more. Where reward does not depend on what the infant does, b changes by chance alone. Its
    own movement varies enough: no noise is added to explore.
    """

    def __init__(self, rate: float = RATE):
        """Begin without any experience."""
        self._rate = rate
        self.strengths = np.zeros(len(LIMBS))
        """How much the activity of each limb predicts reward, in standard deviations, shape (6,)."""
        self._reward, self._activity = Expected(1), Expected(len(LIMBS))

    @property
    def gains(self) -> FloatArray:
        """The gain of each limb, shape (6,)."""
        return np.exp(np.clip(EFFORT * self.strengths, -LARGEST, LARGEST))

    def feel(self, reward: float, activity: FloatArray) -> None:
        """Learn from a window that has just ended.

        Args:
            reward: How fast what it sees has moved, [m/s]; next to 0 is nothing, of which nothing is learnt.
            activity: Mean size of the commands to each limb, before gains, shape (6,).
        """
        self.strengths = (1.0 - WINDOW_S / FORGETTING_S) * self.strengths
        active = np.clip(self._activity.standardised(activity), -MOST, MOST)
        if reward < SMALLEST_REWARD:
            return
        surprise = np.clip(self._reward.standardised(np.array([reward])), -MOST, MOST)
        self.strengths = self.strengths + self._rate * (surprise - self.strengths @ active) * active
