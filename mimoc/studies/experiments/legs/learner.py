"""A learner that does more of whatever it did when the world moved: reward-modulated learning of gains."""

import numpy as np

from mimoc.senses.sense import FloatArray
from mimoc.studies.experiments.legs.driving import LIMBS

WINDOW_S = 2.0
"""Time over which reward and activity are averaged; a guess."""
RATE = 0.03
"""Step of the logarithm of a gain where both reward and activity are a standard deviation above their means; fitted."""
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
    """Learns a gain exp(w) for the drive of each limb, by how its activity and reward go together.

    After each window, with the activity a of each limb (the mean size of its commands, before gains) and the reward R,

        w <- (1 - window / forgetting) w + rate (R - E[R]) / S[R] (a - E[a]) / S[a],

    E and S being running means and standard deviations, of at most 3 S each. Where reward does not depend on what the
    infant does, both factors are independent, so that w changes by chance alone. The infant's own movement varies
    enough: no noise is added to explore.
    """

    def __init__(self, rate: float = RATE):
        """Begin without any experience."""
        self._rate = rate
        self.weights = np.zeros(len(LIMBS))
        """The logarithm of the gain of each limb, shape (6,)."""
        self._reward, self._activity = Expected(1), Expected(len(LIMBS))

    @property
    def gains(self) -> FloatArray:
        """The gain of each limb, shape (6,)."""
        return np.exp(self.weights)

    def feel(self, reward: float, activity: FloatArray) -> None:
        """Learn from a window that has just ended.

        Args:
            reward: How fast what it sees has moved, [m/s]; next to 0 is nothing, of which nothing is learnt.
            activity: Mean size of the commands to each limb, before gains, shape (6,).
        """
        self.weights = (1.0 - WINDOW_S / FORGETTING_S) * self.weights
        active = np.clip(self._activity.standardised(activity), -3.0, 3.0)
        if reward < SMALLEST_REWARD:
            return
        surprise = np.clip(self._reward.standardised(np.array([reward])), -3.0, 3.0)
        self.weights = np.clip(self.weights + self._rate * surprise * active, -LARGEST, LARGEST)
