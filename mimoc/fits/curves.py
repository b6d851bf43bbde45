"""The growth law f(x) = a log(x + b) + c, fitted by least squares (paper, eq. 1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

B_MIN_MONTHS = 0.1
"""Smallest shift: keeps the curve finite at birth (paper, eq. 1)."""
B_MAX_MONTHS = 5e3
"""Largest shift: over two years the curve is then as good as straight."""
_GRID_POINTS, _ROUNDS = 33, 9
"""Each round looks sixteen times closer: to nine digits of log b, all that rounding leaves of a minimum."""


@dataclass(frozen=True, slots=True)
class LogCurve:
    """A measurement by age: a log(age + b) + c."""

    a: float
    """Growth per unit of log age, in the unit of the measurement."""
    b_months: float
    """Shift of the age, at least 0.1."""
    c: float
    """Offset, in the unit of the measurement."""

    def __call__(self, age_months: float) -> float:
        """Return the measurement at *age_months*, in the unit it was fitted in."""
        return float(self.a * np.log(age_months + self.b_months) + self.c)


def fit_log_curve(ages_months: Sequence[float], values: Sequence[float]) -> LogCurve:
    """Return the least-squares curve through *values* at *ages_months*.

    For a given b the law is linear in a and c, so what is left is a search along log b: a grid over its
    whole range, then ever finer ones around the best point. It cannot diverge.

    Args:
        ages_months: Shape (n,), n >= 3, none below zero.
        values: Shape (n,), in any unit.
    """
    ages, y = np.asarray(ages_months, dtype=float), np.asarray(values, dtype=float)
    log_b, low, high = 0.0, np.log(B_MIN_MONTHS), np.log(B_MAX_MONTHS)
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _GRID_POINTS)
        best = int(np.argmin(_residual(np.exp(grid), ages, y)))
        log_b, low, high = grid[best], grid[max(best - 1, 0)], grid[min(best + 1, _GRID_POINTS - 1)]
    b = float(np.exp(log_b))
    x = np.log1p(ages / b)
    a = float((x - x.mean()) @ (y - y.mean()) / ((x - x.mean()) @ (x - x.mean())))
    return LogCurve(a=a, b_months=b, c=float(y.mean() - a * x.mean() - a * np.log(b)))


def _residual(b: FloatArray, ages: FloatArray, y: FloatArray) -> FloatArray:
    """Return the sum of squares left by the best a and c for each b, shape (len(b),)."""
    x = np.log1p(ages / b[:, None])  # log(t + b) less a constant: digits survive a large b.
    x -= x.mean(axis=1, keepdims=True)
    centred = y - y.mean()
    return centred @ centred - (x @ centred) ** 2 / (x * x).sum(axis=1)
