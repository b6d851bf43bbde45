"""A learner that makes more of whatever moved the limbs when the world moved: reward-modulated exploration of gains."""

import numpy as np

from mimoc.senses.sense import FloatArray
from mimoc.studies.experiments.legs.driving import LIMBS

WINDOW_S = 2.0
"""Time for which gains are tried, and over which reward is averaged."""
EXPLORATION = 0.35
"""Standard deviation of the logarithm of a gain while it is tried."""
RATE = 0.05
"""Step of the logarithm of a gain for a reward one standard deviation above what was expected; fitted."""
FORGETTING_S = 300.0
"""Time constant in which gains go back to 1; fitted."""
EXPECTING_S = 60.0
"""Time constant of the mean and of the variance of reward that are expected; a guess."""
LARGEST = float(np.log(4.0))
"""Of the logarithm of a gain."""
SMALLEST_REWARD = 1e-4
"""Reward below which nothing is seen, [m/s]."""


class GainLearner:
    """Learns a gain for the drive of each limb from reward, as REINFORCE does (Williams 1992, Mach Learn 8: 229).

    In each window, the logarithms of the gains are w + s ξ, with ξ standard normal and s = EXPLORATION. Then a reward
    R changes

        w <- (1 - window / forgetting) w + η (R - E) / S ξ,

    E and S being running mean and standard deviation of reward. Where reward does not depend on what the infant does,
    R and ξ are independent, so that w changes by chance alone.
    """

    def __init__(self, generator: np.random.Generator, rate: float = RATE):
        """Begin without any experience."""
        self._generator, self._rate = generator, rate
        self.weights = np.zeros(len(LIMBS))
        """The logarithm of the gain of each limb that is learnt, shape (6,)."""
        self._tried = np.zeros(len(LIMBS))
        self._mean, self._variance, self._windows = 0.0, 0.0, 0

    def gains(self) -> FloatArray:
        """Draw the gains of the next window, shape (6,)."""
        self._tried = self._generator.standard_normal(len(LIMBS))
        return np.exp(np.clip(self.weights + EXPLORATION * self._tried, -LARGEST, LARGEST))

    def feel(self, reward: float) -> None:
        """Learn from the reward of the window that has just ended; a reward of 0 is none."""
        self.weights = (1.0 - WINDOW_S / FORGETTING_S) * self.weights
        if reward < SMALLEST_REWARD:
            return  # Nothing is seen to move, and nothing is learnt of it.
        self._windows += 1
        share = max(WINDOW_S / EXPECTING_S, 1.0 / self._windows)
        surprise = reward - self._mean
        self._mean += share * surprise
        self._variance = (1.0 - share) * (self._variance + share * surprise**2)
        if self._windows > 1 and self._variance > 0.0:
            step = self._rate * surprise / np.sqrt(self._variance)
            self.weights = np.clip(self.weights + step * self._tried, -LARGEST, LARGEST)
