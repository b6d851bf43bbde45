"""A learner that does more of what makes the world move: gains of limbs by how their movement predicts reward."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimoc.runtime.sense import FloatArray
from mimoc.studies.comparison import interval, sign_test
from mimoc.studies.experiment import Results
from mimoc.studies.experiments.legs import LIMBS
from mimoc.studies.notebook import table_rows

WINDOW_S = 2.0  # Time over which reward and movement are averaged; a guess.
EXPECTED = len(LIMBS) ** -0.5
"""Standard deviation of what one limb may predict, before any experience: that all of them together predict all."""
FORGETTING_S = 300.0  # Time constant in which experience loses its worth; fitted.
EFFORT = 10.0  # Logarithm of the gain of a limb that predicts reward fully; fitted.
MOST = 3.0  # Standard deviations beyond which nothing counts more.
EXPECTING_S = 60.0  # Time constant of the means and variances that are expected; a guess.
LARGEST = float(np.log(4.0))  # Of the logarithm of a gain; a guess.
SMALLEST_REWARD = 1e-4  # Reward below which nothing is seen to move, [m/s].

PAGE_NUMBERS = {"window": WINDOW_S, "largest": np.exp(LARGEST), "effort": EFFORT, "forgetting": FORGETTING_S}


class Expected:
    """Running mean and variance of some numbers: the plain ones at first, later those of the last minute."""

    def __init__(self, size: int):
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
    """Learns how much each limb moves the world, and drives those that do with a gain.

    After each window, with z the standardised movement of each limb and R the standardised reward, it estimates the
    strengths b of R = b · z + noise by a Kalman filter (Dayan & Kakade 2001, *NIPS* 13: 451, whose b and their
    covariance P do what the associations of Rescorla & Wagner 1972 do, and know how sure they are). Between windows the
    world may change, k = exp(-window / forgetting):

        b <- k b,  P <- k² P + (1 - k²) I / 6;  g = P z / (z · P z + 1),  b <- b + g (R - b · z),  P <- P - g z · P

    The gain of a limb is exp(effort b |b|): b² is the share of the reward's variance that it alone explains. Limbs
    compete: one that only moves together with another that moves the world predicts nothing more. Where reward does not
    depend on what the infant does, b stays near 0, and its square nearer. Its own movement varies enough: no noise is
    added to explore.
    """

    def __init__(self):
        self.strengths = np.zeros(len(LIMBS))
        """How much the movement of each limb predicts reward, in standard deviations, shape (6,)."""
        self._covariance = EXPECTED**2 * np.eye(len(LIMBS))
        self._reward, self._movement = Expected(1), Expected(len(LIMBS))

    @property
    def gains(self) -> FloatArray:
        """The gain of each limb, shape (6,)."""
        return np.exp(np.clip(EFFORT * self.strengths * np.abs(self.strengths), -LARGEST, LARGEST))

    def feel(self, reward: float, movement: FloatArray) -> None:
        """Learn from a window that has just ended, in which what it sees moved by *reward*, [m/s].

        Of next to no reward nothing is learnt; the movement of each limb, shape (6,), can have any unit.
        """
        keep = np.exp(-WINDOW_S / FORGETTING_S)
        self.strengths = keep * self.strengths
        self._covariance = keep**2 * self._covariance + (1.0 - keep**2) * EXPECTED**2 * np.eye(len(LIMBS))
        moved = np.clip(self._movement.standardised(movement), -MOST, MOST)
        if reward < SMALLEST_REWARD:
            return
        surprise = np.clip(self._reward.standardised(np.array([reward])), -MOST, MOST)
        shared = self._covariance @ moved
        share = shared / (moved @ shared + 1.0)
        self.strengths = self.strengths + share * (surprise - self.strengths @ moved)
        self._covariance = self._covariance - np.outer(share, shared)


@dataclass(frozen=True, slots=True)
class Phases:
    """The phases of a session."""

    lengths_s: tuple[float, ...]
    longest_s: float  # Most of the end of a phase by which it is judged.

    @property
    def ends_s(self) -> tuple[float, ...]:
        """When each phase ends."""
        return tuple(np.cumsum(self.lengths_s).tolist())

    @property
    def compared_s(self) -> float:
        """How much of the end of each phase is compared."""
        return min(self.longest_s, *self.lengths_s)

    def counts(self, times_s: FloatArray) -> list[int]:
        """Return how many of some times, shape (n,), are within the end of each phase that is compared."""
        return [int(((times_s >= end_s - self.compared_s) & (times_s < end_s)).sum()) for end_s in self.ends_s]


def rates_per_min(times_s: FloatArray, seconds: float, bin_s: float) -> tuple[float, ...]:
    """Return how many of some times, shape (n,), there are a minute in each bin of a session."""
    counts, _ = np.histogram(times_s, np.arange(round(seconds / bin_s) + 1) * bin_s)
    return tuple((60.0 * counts / bin_s).tolist())


def differences(results: Results, case: Phases, larger: str, smaller: str) -> list[float]:
    """Return by how much one measure exceeds another in each trial."""
    return [a - b for a, b in zip(results.values(case, larger), results.values(case, smaller), strict=True)]


def direction_rows(results: Results, case: Phases, asked: Mapping[str, tuple[str, str]]) -> str:
    """Return rows of a table on measures that are predicted to exceed others: difference, number of trials, and p."""
    rows = list[tuple[str, ...]]()
    for name, measures in asked.items():
        values = differences(results, case, *measures)
        holds = f"{sum(value > 0 for value in values)} of {len(values)}"
        rows.append((name, interval(values).text(), holds, f"{sign_test(values):.2g}"))
    return table_rows(rows)
