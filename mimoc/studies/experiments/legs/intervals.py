"""Means over seeds with their intervals, tests of a direction, and what a condition changes, seed by seed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import comb, sqrt
from statistics import fmean, stdev

from scipy.stats import t

from mimoc.base.geometry.rotations import FloatArray
from mimoc.render.plots.plot import Band


@dataclass(frozen=True, slots=True)
class Interval:
    """The mean over seeds, and where 95 % of such intervals have the true mean (Student's t)."""

    mean: float
    low: float
    high: float

    def text(self, digits: int = 2, *, percent: bool = False) -> str:
        """Return it as text: `1.23 (1.10 to 1.36)`."""
        if percent:
            return f"{self.mean:+.0%} ({self.low:+.0%} to {self.high:+.0%})"
        return f"{self.mean:.{digits}f} ({self.low:.{digits}f} to {self.high:.{digits}f})"

    def overlaps(self, low: float | None, high: float | None) -> bool:
        """Return whether the mean is inside a range, whose ends can be open."""
        return (low is None or self.mean >= low) and (high is None or self.mean <= high)


def interval(values: Sequence[float]) -> Interval:
    """Return the mean of at least one value with its interval, which is as wide as nothing for a single one."""
    mean = fmean(values)
    if len(values) < 2:
        return Interval(mean, mean, mean)
    half = float(t.ppf(0.975, len(values) - 1)) * stdev(values) / sqrt(len(values))
    return Interval(mean, mean - half, mean + half)


def band_of(x: Sequence[float] | FloatArray, means: Sequence[Interval], label: str = "", look: str = "spread") -> Band:
    """Return the intervals of means along x, shape (n,), as a band of a plot."""
    return Band(x, [mean.low for mean in means], [mean.high for mean in means], label, look)


def band_of_seeds(x: FloatArray, curves: FloatArray, label: str) -> Band:
    """Return the intervals of the means of curves, shape (seeds, n), as a band of a plot."""
    return band_of(x, [interval(column.tolist()) for column in curves.T], label)


def sign_test(changes: Sequence[float]) -> float:
    """Return how likely at least as many rises would be if rises and falls were equally likely; ties are left out.

    >>> sign_test([1.0] * 10 + [-1.0] * 2)
    0.019287109375
    """
    moved = [change > 0 for change in changes if change]
    count, rises = len(moved), sum(moved)
    return sum(comb(count, more) for more in range(rises, count + 1)) / 2**count


LEVEL = 0.05  # Chance below which a direction counts as shown.
Values = Sequence[Mapping[str, float]]  # Measures of each seed.


def relative_changes(plain: Values, changed: Values, measure: str) -> list[float]:
    """Return (c - p) / mean(p) of each seed, p and c being its values without and with a condition.

    Of seeds without a value, nothing is returned; nothing at all if the mean is zero.
    """
    pairs = [(p[measure], c[measure]) for p, c in zip(plain, changed, strict=True) if measure in p and measure in c]
    mean = fmean(before for before, _ in pairs) if pairs else 0.0
    return [(after - before) / mean for before, after in pairs] if mean else []


def change_text(changes: Sequence[float]) -> str:
    """Return a mean change with its interval, and how many seeds it has the direction of."""
    if not changes:
        return "-"
    mean = interval(changes)
    rises = mean.mean > 0
    same = sum((change > 0) == rises for change in changes if change)
    return f"{mean.text(percent=True)}, {same} of {len(changes)}"


def direction(changes: Sequence[float], least: float = 0.0) -> str:
    """Return `more` or `less` if too many seeds change so for chance (p < .05), and the mean by at least some share.

    Otherwise `same`; with so few seeds that not even all of them would do, `unclear`.
    """
    if 0.5 ** len(changes) >= LEVEL:
        return "unclear"
    mean = interval(changes).mean
    if mean >= least and sign_test(changes) < LEVEL:
        return "more"
    return "less" if mean <= -least and sign_test([-change for change in changes]) < LEVEL else "same"
