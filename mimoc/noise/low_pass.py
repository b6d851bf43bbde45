"""Gaussian noise that changes gradually, with mean 0, standard deviation 1 and a time constant."""

import math

import numpy as np

from mimoc.senses.sense import FloatArray

FORGOTTEN = 700.0
"""Number of time constants after which nothing of a value is left."""


class LowPassed:
    """White noise after a low-pass filter of first order: values correlate by exp(-t / T) over a time t.

    The statistics are exact for any interval between values, so they do not depend on the physics step.
    """

    def __init__(self, count: int, time_constant_s: float):
        """Keep so many independent values."""
        self.values = np.zeros(count)
        """The present values, shape (count,)."""
        self._time_constant_s = time_constant_s

    def advance(self, elapsed_s: float, generator: np.random.Generator) -> FloatArray:
        """Return the values after some time, shape (count,); after an infinite time they are drawn anew."""
        kept, added = low_pass_step(elapsed_s, self._time_constant_s)
        self.values = kept * self.values + added * generator.standard_normal(len(self.values))
        return self.values


class Smooth:
    """White noise after a critically damped low-pass filter of second order: smooth values, and their rates.

    A value has the standard deviation 1, its rate 1 / T, and the rate is the derivative of the value.
    """

    def __init__(self, count: int, time_constant_s: float):
        """Keep so many independent values and rates."""
        self.values = np.zeros((2, count))
        """The present values, and their rates by the time constant, shape (2, count)."""
        self._time_constant_s = time_constant_s

    def advance(self, elapsed_s: float, generator: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Return the values and their rates [1/s] after some time, shape (count,) each; see `LowPassed.advance`."""
        kept, added = smooth_step(elapsed_s, self._time_constant_s)
        self.values = kept @ self.values + added @ generator.standard_normal(self.values.shape)
        return self.values[0], self.values[1] / self._time_constant_s


def low_pass_step(elapsed_s: float, time_constant_s: float) -> tuple[float, float]:
    """Return the shares of the present value and of a new random number in the value after some time."""
    kept = math.exp(-elapsed_s / time_constant_s)
    return kept, math.sqrt(1 - kept * kept)


def smooth_step(elapsed_s: float, time_constant_s: float) -> tuple[FloatArray, FloatArray]:
    """Return the same of a smooth value and its rate by the time constant, shape (2, 2) each."""
    kept = _transition(min(elapsed_s / time_constant_s, FORGOTTEN))
    return kept, _root(np.eye(2) - kept @ kept.T)


def _transition(past: float) -> FloatArray:
    """Return what a value and its rate contribute to those that many time constants later, shape (2, 2)."""
    return math.exp(-past) * np.array([[1 + past, past], [-past, 1 - past]])


def _root(covariance: FloatArray) -> FloatArray:
    """Return the lower triangular matrix that times its transpose is a covariance, shape (2, 2)."""
    (variance, mixed), (_, other) = covariance.tolist()
    first = math.sqrt(max(variance, 0.0))
    second = mixed / first if first else 0.0
    return np.array([[first, 0.0], [second, math.sqrt(max(other - second * second, 0.0))]])
