"""Gaussian noise that changes gradually, with mean 0, standard deviation 1 and a time constant.

The statistics are exact for any interval between values, so they do not depend on the physics step.
"""

import math
from dataclasses import dataclass
from typing import Any

FORGOTTEN = 700.0
"""Number of time constants after which nothing of a value is left."""


@dataclass(frozen=True, slots=True)
class LowPass:
    """White noise after a low-pass filter of first order, whose values correlate by exp(-t / T) over a time t.

    With random numbers n, a value x becomes a x + √(1 - a²) n after a time t, where a = exp(-t / T).
    """

    time_constant_s: float
    """T."""

    def __call__(self, values: Any, elapsed_s: float, drawn: Any) -> Any:
        """Return the values after some time, shape (k, n); those drawn if there are none before."""
        if values is None:
            return drawn
        kept = math.exp(-elapsed_s / self.time_constant_s)
        return kept * values + math.sqrt(1 - kept * kept) * drawn


@dataclass(frozen=True, slots=True)
class Smooth:
    """White noise after a critically damped low-pass filter of second order: smooth values, and their rates.

    A value has the standard deviation 1, its rate 1 / T, and the rate is the derivative of the value. With p = t / T, a
    value and T times its rate, z = (x, y), become A z + L n after a time t, where A = exp(-p) (1 + p, p; -p, 1 - p),
    and L is lower triangular with L Lᵀ = 1 - A Aᵀ.
    """

    time_constant_s: float
    """T."""

    def __call__(self, xp: Any, values: Any, elapsed_s: float, drawn: Any) -> Any:
        """Return the values, then T times their rates after some time, shape (k, 2 n); see `LowPass`."""
        if values is None:
            return drawn
        (xx, xy), (yx, yy), (first, mixed, second) = smooth_step(elapsed_s / self.time_constant_s)
        count = values.shape[1] // 2
        value, rate, one, other = values[:, :count], values[:, count:], drawn[:, :count], drawn[:, count:]
        changed = [xx * value + xy * rate + first * one, yx * value + yy * rate + (mixed * one + second * other)]
        return xp.concat(changed, axis=1)


def smooth_step(times: float) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float, float]]:
    """Return both rows of A, and the numbers of L row by row, after some time constants; see `Smooth`."""
    past = min(times, FORGOTTEN)
    decay = math.exp(-past)
    value, rate = (decay * (1 + past), decay * past), (decay * -past, decay * (1 - past))
    first = math.sqrt(max(1 - value[0] ** 2 - value[1] ** 2, 0.0))
    mixed = -(value[0] * rate[0] + value[1] * rate[1]) / first if first else 0.0
    return value, rate, (first, mixed, math.sqrt(max(1 - rate[0] ** 2 - rate[1] ** 2 - mixed * mixed, 0.0)))
