"""What was measured beside figures of real infants or of a paper: ranges, intervals over seeds, sign tests."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import comb, sqrt
from pathlib import Path
from statistics import fmean, stdev
from typing import Literal, TypeVar

import numpy as np

from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.rounding import rounded
from mimoc.render.plots import Band
from mimoc.schema.base import Model

Certainty = Literal["read", "read in another source", "recorded", "derived", "assumption"]
"""Read in the source or its abstract, or in another text that reports it; measured on recordings of real infants;
derived from such figures; or an assumption: nobody is judged by it."""
ASSUMPTION = "assumption"
READ: tuple[Certainty, ...] = ("read", "read in another source")
Basis = Literal["fitted", "predicted"]
"""Whether a number of the law `maturing` was chosen for a figure, so that it is reproduced, or none was."""


class Reference(Model):
    """Values that real infants of some ages have."""

    youngest_months: float
    oldest_months: float
    low: float | None
    """None if there is no lower end, as for `high`."""
    high: float | None
    used: Basis = "predicted"
    """Whether a number of the law `maturing` is chosen for this figure, or none is, so that it is predicted."""
    certainty: Certainty
    source: str

    def holds_at(self, age_months: float) -> bool:
        """Return whether it is about infants of an age."""
        return self.youngest_months <= age_months <= self.oldest_months

    @property
    def is_read_direction(self) -> bool:
        """Whether it is a fact that was read, and says which way a value has to go: it has one end."""
        return self.certainty in READ and (self.low is None) != (self.high is None)

    def has(self, value: float) -> bool:
        """Return whether a value is inside."""
        return (self.low is None or value >= self.low) and (self.high is None or value <= self.high)

    def error(self, value: float) -> float:
        """Return how far a value is below the lower end, as a number below 0, or above the upper one; 0 inside."""
        end = self.low if self.low is not None and value < self.low else self.high
        return 0.0 if self.has(value) or end is None else value - end


Verdict = Literal["inside", "outside", "too early", "too late", "not reached", "no verdict", "not tried"]
GOOD: tuple[Verdict, ...] = ("inside", "no verdict")


class AgeRange(Model):
    """Ages at which infants reach a milestone, in months."""

    youngest_months: float
    oldest_months: float
    usual_months: float | None
    """The mean, or the age that a source gives; None if it gives none."""
    sd_months: float | None = None
    """Standard deviation of the ages of infants; None if the source gives none."""
    span: str
    """What these ages are, such as percentiles."""
    source: str
    certainty: Certainty

    @property
    def ages(self) -> tuple[float, ...]:
        """Youngest, usual and oldest age."""
        usual = () if self.usual_months is None else (self.usual_months,)
        return (self.youngest_months, *usual, self.oldest_months)

    def window(self, *, of_average: bool) -> tuple[float, float]:
        """Return the ages that a child is judged by, youngest and oldest.

        An average child is judged by the mean ± 1 SD where both are known, since nearly any age is within the 1st and
        99th percentile; others are judged by the whole range.
        """
        if of_average and self.usual_months is not None and self.sd_months is not None:
            return rounded(self.usual_months - self.sd_months), rounded(self.usual_months + self.sd_months)
        return self.youngest_months, self.oldest_months

    def verdict(self, age_months: float | None, *, of_average: bool = False) -> Verdict:
        """Return how the age at which an infant reaches it compares; None is never. Nobody is judged by assumptions."""
        youngest_months, oldest_months = self.window(of_average=of_average)
        if self.certainty == ASSUMPTION:
            return "no verdict"
        if age_months is None:
            return "not reached"
        if age_months < youngest_months:
            return "too early"
        return "inside" if age_months <= oldest_months else "too late"


Row = TypeVar("Row", bound=Model)


def read_figures(path: Path, kind: type[Row]) -> Iterator[tuple[str, Row]]:
    """Yield the rows of a CSV, each with what stands in its first column; an empty cell is None."""
    with path.open(encoding="utf-8", newline="") as file:
        _, *rest = next(lines := csv.reader(file))
        for name, *cells in lines:
            yield name, kind.model_validate({key: cell or None for key, cell in zip(rest, cells, strict=True)})


@dataclass(frozen=True, slots=True)
class Figure:
    """What a paper has of a quantity."""

    quantity: str  # Its name and unit, or a statement that holds or does not.
    paper: str  # A number as it is given, or a word.
    certainty: str  # `S`: read in the paper or its code; `D`: derived from them; `M`: from memory.
    source: str  # Where in the paper or its code.

    def row(self, measured: float | str | None) -> tuple[str, ...]:
        """Return its row of the table; numbers measured have a digit more than the paper's, and None is never."""
        known = f"{self.certainty}: {self.source}"
        if isinstance(measured, str | None):
            ours = "never" if measured is None else measured
            return self.quantity, self.paper, ours, "" if ours == self.paper else "differs", known
        decimals = self.paper.partition(".")[2]
        digits = len(decimals) + 1 if decimals else 0
        sign = "+" if self.paper[0] in "+-" else ""
        difference = measured - float(self.paper)
        return self.quantity, self.paper, f"{measured:{sign}z.{digits}f}", f"{difference:+z.{digits}f}", known


@dataclass(frozen=True, slots=True)
class Interval:
    """The mean over seeds with its 95 % confidence interval (Student's t)."""

    mean: float
    low: float
    high: float

    def text(self, digits: int = 2, *, percent: bool = False) -> str:
        """Return it as text: `1.23 (1.10 to 1.36)`."""
        if percent:
            return f"{self.mean:+.0%} ({self.low:+.0%} to {self.high:+.0%})"
        return f"{self.mean:.{digits}f} ({self.low:.{digits}f} to {self.high:.{digits}f})"


def interval(values: Sequence[float]) -> Interval:
    """Return the mean of at least one value with its interval, whose width is 0 for a single value."""
    from scipy.stats import t

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
    return band_of(x, [interval(column) for column in np.transpose(curves).tolist()], label)


def sign_test(changes: Sequence[float]) -> float:
    """Return the probability of at least as many rises if rises and falls were equally likely; ties are left out.

    >>> sign_test([1.0] * 10 + [-1.0] * 2)
    0.019287109375
    """
    moved = [change > 0 for change in changes if change]
    count, rises = len(moved), sum(moved)
    return sum(comb(count, more) for more in range(rises, count + 1)) / 2**count


LEVEL = 0.05  # Probability below which a direction counts as shown.
SeedValues = Sequence[Mapping[str, float]]  # Measures of each seed.


def relative_changes(plain: SeedValues, changed: SeedValues, measure: str) -> list[float]:
    """Return (c - p) / mean(p) of each seed, p and c being its values without and with a condition.

    Seeds that lack a value are left out; if the mean is zero, all are.
    """
    pairs = [(p[measure], c[measure]) for p, c in zip(plain, changed, strict=True) if measure in p and measure in c]
    mean = fmean(before for before, _ in pairs) if pairs else 0.0
    return [(after - before) / mean for before, after in pairs] if mean else []


def change_text(changes: Sequence[float]) -> str:
    """Return a mean change with its interval, and how many seeds change in its direction."""
    if not changes:
        return "-"
    mean = interval(changes)
    rises = mean.mean > 0
    same = sum((change > 0) == rises for change in changes if change)
    return f"{mean.text(percent=True)}, {same} of {len(changes)}"


def direction(changes: Sequence[float], least: float = 0.0) -> str:
    """Return `more` or `less` if a sign test shows it (p < .05) and the mean changes by at least *least*; else `same`.

    With so few seeds that the test could not show it even if all of them agreed, it is `unclear`.
    """
    if 0.5 ** len(changes) >= LEVEL:
        return "unclear"
    mean = interval(changes).mean
    if mean >= least and sign_test(changes) < LEVEL:
        return "more"
    return "less" if mean <= -least and sign_test([-change for change in changes]) < LEVEL else "same"
