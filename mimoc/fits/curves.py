"""Growth curves, fitted by least squares: a log(x + b) + c, and the same with a steady growth d x besides.

The first is the law of the paper (López et al. 2025, eq. 1). The second is Count's model of growth in childhood (Count
1943, Human Biology 15: 1-32; M), where a child grows fast at first and steadily later. Without the steady part a curve
that is steep enough at birth is too flat by two years: boys of four months are 1.15 standard deviations too short.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.rounding import significant

B_MIN_MONTHS = 0.1  # Smallest shift: keeps the curve finite at birth (paper, eq. 1).
B_MAX_MONTHS = 5e3  # Largest shift: over two years the curve is then as good as straight.
B_MAX_COUNT_MONTHS = 100.0
"""Largest shift beside a steady growth, from which the logarithm can hardly be told any more."""
LAST_MONTH = 24.0  # Age up to which no curve with a steady part may fall.
SHIFT_DIGITS, DIGITS = 9, 10
"""Significant digits of b, to which a fit is hardly sensitive, and of the other coefficients, which follow from it: one
more than files have, and few enough that they are the same however a processor takes logarithms and sums."""
_GRID_POINTS, _ROUNDS = 33, 8  # Each round looks 32 times closer: to twelve digits of log b.


@dataclass(frozen=True, slots=True)
class LogCurve:
    """A measurement by age: a log(age + b) + c + d age."""

    a: float  # Growth per unit of log age, in the unit of the measurement.
    b_months: float  # Shift of the age, at least 0.1.
    c: float  # Offset, in the unit of the measurement.
    d: float = 0.0  # Steady growth per month, in the unit of the measurement; 0 by the law of the paper.

    def __call__(self, age_months: float) -> float:
        """Return the measurement at *age_months*, in the unit it was fitted in."""
        return self.a * math.log(age_months + self.b_months) + self.c + self.d * age_months


def fit_log_curve(ages_months: Sequence[float], values: Sequence[float]) -> LogCurve:
    """Return the least-squares curve by the law of the paper through *values* at *ages_months*.

    Args:
        ages_months: Shape (n,), n >= 3, none below zero.
        values: Shape (n,), in any unit.
    """
    points = _Points(np.array(ages_months, float), np.array(values, float), np.ones(len(values)), is_steady=False)
    return _curve(points, _best_shift(points, B_MAX_MONTHS))


def fit_count_curve(ages_months: Sequence[float], values: Sequence[float], weights: Sequence[float]) -> LogCurve:
    """Return the least-squares curve with a steady part through *values* that does not fall up to `LAST_MONTH`.

    Where growth never slows down, that is the curve by the law of the paper, nearly a straight line; where values fall,
    their mean.

    Args:
        ages_months: Shape (n,), n >= 5, none below zero.
        values: Shape (n,), in any unit.
        weights: Of the squared deviations, shape (n,).
    """
    points = _Points(*(np.array(column, float) for column in (ages_months, values, weights)), is_steady=True)
    b = _best_shift(points, B_MAX_COUNT_MONTHS)
    if not math.isnan(b):
        return _curve(points, b)
    bent = fit_log_curve(ages_months, values)
    return bent if bent.a >= 0 else LogCurve(0.0, B_MIN_MONTHS, significant(float(points.mean(points.y)[0]), DIGITS))


@dataclass(frozen=True, slots=True)
class _Points:
    """What a curve is fitted to."""

    ages: FloatArray
    y: FloatArray
    weights: FloatArray
    is_steady: bool  # Whether the curve has a steady part.

    def mean(self, values: FloatArray) -> FloatArray:
        """Return the weighted mean over the points, the last axis, which is kept."""
        return (values * self.weights).sum(axis=-1, keepdims=True) / self.weights.sum()


class _Fits(NamedTuple):
    """The best curve for each shift, shape (n,)."""

    a: FloatArray
    d: FloatArray
    left: FloatArray  # The weighted mean of the squared deviations; infinite if the curve falls.
    slope: FloatArray  # Its derivative by log b.


def _fits(points: _Points, b: FloatArray) -> _Fits:
    """Return the best curves with some shifts; for a given b the law is linear in all else."""
    x = np.log1p(points.ages / b[:, None])  # log(t + b) less a constant: digits survive a large b.
    x, t, v = (values - points.mean(values) for values in (x, points.ages, points.y))
    x_steady, v_steady = np.zeros((len(b), 1)), np.zeros(1)
    if points.is_steady:
        x_steady, v_steady = (points.mean(values * t) / points.mean(t * t) for values in (x, v))
    bent, rest = x - x_steady * t, v - v_steady * t  # What a straight line leaves of each.
    a = points.mean(bent * rest) / points.mean(bent * bent)
    d = v_steady - a * x_steady
    errors = rest - a * bent
    falls = (a < 0) | (a / (LAST_MONTH + b[:, None]) + d < 0) if points.is_steady else np.zeros(a.shape, dtype=bool)
    left = np.where(falls, np.inf, points.mean(errors * errors))
    slope = 2 * a * points.mean(errors * points.ages / (b[:, None] + points.ages))
    return _Fits(a[:, 0], d[:, 0], left[:, 0], slope[:, 0])


def _best_shift(points: _Points, largest_months: float) -> float:
    """Return the b with which least is left; NaN if every curve falls.

    This searches along log b: a grid over the whole range for the best point, then ever finer ones beside it for where
    what is left begins to rise, which is known to many more digits than where it is least. It cannot diverge.
    """
    grid = np.linspace(math.log(B_MIN_MONTHS), math.log(largest_months), _GRID_POINTS)
    left = _fits(points, np.exp(grid)).left
    if not np.isfinite(left).any():
        return math.nan
    low, high = _neighbours(grid, int(left.argmin()) - 1, 2)
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _GRID_POINTS)
        fits = _fits(points, np.exp(grid))
        rises = np.where(np.isfinite(fits.left), fits.slope >= 0, np.arange(_GRID_POINTS) > fits.left.argmin())
        low, high = _neighbours(grid, int(rises.argmax() if rises.any() else _GRID_POINTS) - 1, 1)
    return significant(math.exp((low + high) / 2), SHIFT_DIGITS)


def _neighbours(grid: FloatArray, first: int, steps: int) -> tuple[float, float]:
    """Return two points of a grid, the second some steps after the first, as far as the grid goes."""
    return float(grid[max(first, 0)]), float(grid[min(first + steps, len(grid) - 1)])


def _curve(points: _Points, b: float) -> LogCurve:
    a, d, *_ = (significant(float(values[0]), DIGITS) for values in _fits(points, np.array([b])))
    c = points.mean(points.y - a * np.log(points.ages + b) - d * points.ages)[0]
    return LogCurve(a=a, b_months=b, c=significant(float(c), DIGITS), d=d)
