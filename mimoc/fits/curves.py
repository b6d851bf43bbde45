"""Growth curves, fitted by least squares: a log(x + b) + c, and the same with a steady growth d x besides.

The first is the law of the paper (López et al. 2025, eq. 1). The second is Count's model of growth in childhood (Count
1943, Human Biology 15: 1-32; M), where a child grows fast at first and steadily later. Without the steady part a curve
that is steep enough at birth is too flat by two years: boys of four months are 1.15 standard deviations too short.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

B_MIN_MONTHS = 0.1
"""Smallest shift: keeps the curve finite at birth (paper, eq. 1)."""
B_MAX_MONTHS = 5e3
"""Largest shift: over two years the curve is then as good as straight."""
B_MAX_COUNT_MONTHS = 100.0
"""Largest shift beside a steady growth, from which the logarithm can hardly be told any more."""
LAST_MONTH = 24.0
"""Age up to which no curve with a steady part may fall."""
_GRID_POINTS, _ROUNDS = 33, 9
"""Each round looks sixteen times closer: to nine digits of log b, all that rounding leaves of a minimum."""


@dataclass(frozen=True, slots=True)
class LogCurve:
    """A measurement by age: a log(age + b) + c + d age."""

    a: float
    """Growth per unit of log age, in the unit of the measurement."""
    b_months: float
    """Shift of the age, at least 0.1."""
    c: float
    """Offset, in the unit of the measurement."""
    d: float = 0.0
    """Steady growth per month, in the unit of the measurement; 0 by the law of the paper."""

    def __call__(self, age_months: float) -> float:
        """Return the measurement at *age_months*, in the unit it was fitted in."""
        return float(self.a * np.log(age_months + self.b_months) + self.c + self.d * age_months)


def fit_log_curve(ages_months: Sequence[float], values: Sequence[float]) -> LogCurve:
    """Return the least-squares curve by the law of the paper through *values* at *ages_months*.

    Args:
        ages_months: Shape (n,), n >= 3, none below zero.
        values: Shape (n,), in any unit.
    """
    ages, y = np.asarray(ages_months, dtype=float), np.asarray(values, dtype=float)
    b = _best_shift(lambda shifts: _residual(shifts, ages, y), B_MAX_MONTHS)
    x = np.log1p(ages / b)
    a = float((x - x.mean()) @ (y - y.mean()) / ((x - x.mean()) @ (x - x.mean())))
    return LogCurve(a=a, b_months=b, c=float(y.mean() - a * x.mean() - a * np.log(b)))


def fit_count_curve(ages_months: Sequence[float], values: Sequence[float], weights: Sequence[float]) -> LogCurve:
    """Return the least-squares curve with a steady part through *values* that does not fall up to `LAST_MONTH`.

    Where growth never slows down, that is the curve by the law of the paper, nearly a straight line.

    Args:
        ages_months: Shape (n,), n >= 5, none below zero.
        values: Shape (n,), in any unit.
        weights: Of the squared deviations, shape (n,).
    """
    ages, y, w = (np.asarray(column, dtype=float) for column in (ages_months, values, weights))

    def residual(shifts: FloatArray) -> FloatArray:
        a, d, left = _count_coefficients(shifts, ages, y, w)
        return np.where((a >= 0) & (a / (LAST_MONTH + shifts) + d >= 0), left, np.inf)

    b = _best_shift(residual, B_MAX_COUNT_MONTHS)
    if not np.isfinite(residual(np.array([b]))[0]):
        return fit_log_curve(ages_months, values)
    (a,), (d,), _ = _count_coefficients(np.array([b]), ages, y, w)
    c = np.average(y - a * np.log(ages + b) - d * ages, weights=w)
    return LogCurve(a=float(a), b_months=b, c=float(c), d=float(d))


def _best_shift(residual: Callable[[FloatArray], FloatArray], largest_months: float) -> float:
    """Return the b with the least residual.

    For a given b the law is linear in all else, so what is left is a search along log b: a grid over its whole range,
    then ever finer ones around the best point. It cannot diverge.
    """
    log_b, low, high = 0.0, np.log(B_MIN_MONTHS), np.log(largest_months)
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _GRID_POINTS)
        best = int(np.argmin(residual(np.exp(grid))))
        log_b, low, high = grid[best], grid[max(best - 1, 0)], grid[min(best + 1, _GRID_POINTS - 1)]
    return float(np.exp(log_b))


def _residual(b: FloatArray, ages: FloatArray, y: FloatArray) -> FloatArray:
    """Return the sum of squares left by the best a and c for each b, shape (len(b),)."""
    x = np.log1p(ages / b[:, None])  # log(t + b) less a constant: digits survive a large b.
    x -= x.mean(axis=1, keepdims=True)
    centred = y - y.mean()
    return centred @ centred - (x @ centred) ** 2 / (x * x).sum(axis=1)


def _count_coefficients(
    b: FloatArray, ages: FloatArray, y: FloatArray, w: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the best a and d and the weighted sum of squares that they leave for each b, shape (len(b),) each."""
    x = np.log1p(ages / b[:, None])
    x -= np.average(x, axis=1, weights=w)[:, None]
    t, v = ages - np.average(ages, weights=w), y - np.average(y, weights=w)
    steady = t * w / (t @ (t * w))
    x_steady, v_steady = x @ steady, v @ steady
    bent, rest = x - x_steady[:, None] * t, v - v_steady * t  # What a straight line leaves of each.
    a = bent @ (w * rest) / ((bent * w) * bent).sum(axis=1)
    left = (((rest - a[:, None] * bent) ** 2) * w).sum(axis=1)
    return a, v_steady - a * x_steady, left
