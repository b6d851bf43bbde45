"""WHO's growth standards: where a child stands among healthy children of its age and sex."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.units import months_to_days

Sex = Literal["male", "female"]
Reference = Literal["male", "female", "mean"]
"""Whom a child is compared with; `mean` is the child between boys and girls: the mean L, M and S."""

SEXES: tuple[Sex, ...] = ("male", "female")
REFERENCES: tuple[Reference, ...] = (*SEXES, "mean")

LAST_Z = 3.0  # How far out the distribution is trusted; beyond it, WHO counts in widths of the third deviation.


@dataclass(frozen=True)
class GrowthStandard:
    """One indicator, as Box-Cox power L, median M and coefficient of variation S by day and sex."""

    tables: Mapping[str, npt.NDArray[np.float64]]  # By sex: rows of (age in days, L, M, S), shape (days, 4).

    @property
    def first_day(self) -> float:
        """Youngest age the standard knows, in days."""
        return max(float(self.tables[sex][0, 0]) for sex in SEXES)

    def covers(self, age_months: float) -> bool:
        """Say whether the standard knows children this young."""
        return months_to_days(age_months) >= self.first_day

    def z_score(self, value: float, age_months: float, reference: Reference) -> float:
        """Return how many standard deviations *value*, above zero, lies above the median."""
        return self._at(age_months, reference).z_score(value)

    def value(self, z: float, age_months: float, reference: Reference) -> float:
        """Return the value at *z* standard deviations, in the indicator's unit: the inverse of `z_score`."""
        return self._at(age_months, reference).value(z)

    def _at(self, age_months: float, reference: Reference) -> "_Distribution":
        """Return L, M and S, linear between days; outside the table, those of its first or last day.

        (24 months are 730.5 days, and the last day is 730.)
        """
        day = months_to_days(age_months)
        sexes = SEXES if reference == "mean" else (reference,)
        return _Distribution(*np.mean([_interpolated(day, self.tables[sex]) for sex in sexes], axis=0).tolist())


def _interpolated(day: float, table: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the row of a table at a day, without the day: as `numpy.interp` would, but all columns at once."""
    after = int(table[:, 0].searchsorted(day, side="right"))
    if after in (0, len(table)):
        return table[max(after - 1, 0), 1:]
    (first_day, first), (last_day, last) = ((row[0], row[1:]) for row in table[after - 1 : after + 1])
    return first + (last - first) / (last_day - first_day) * (day - first_day)


def percentile(z: float) -> float:
    """Return the percentile of a z-score, 0 to 100."""
    return 100 * NormalDist().cdf(z)


@dataclass(frozen=True, slots=True)
class _Distribution:
    """How an indicator varies at one age: normal after a Box-Cox transform (Cole's LMS method).

    Beyond three deviations a distance is counted in the width between the second and the third, as
    WHO does for skewed indicators (WHO 2006, section 7; for L = 1 it makes no difference).
    """

    power: float
    median: float
    variation: float

    def z_score(self, value: float) -> float:
        z = self._box_cox(value)
        if abs(z) <= LAST_Z:
            return z
        side = math.copysign(1, z)
        return side * LAST_Z + (value - self._inverse(side * LAST_Z)) / self._outer_width(side)

    def value(self, z: float) -> float:
        if abs(z) <= LAST_Z:
            return self._inverse(z)
        side = math.copysign(1, z)
        return self._inverse(side * LAST_Z) + (z - side * LAST_Z) * self._outer_width(side)

    def _outer_width(self, side: float) -> float:
        """Return the width between the second and the third deviation on a side, +1 or -1."""
        return side * (self._inverse(side * LAST_Z) - self._inverse(side * (LAST_Z - 1)))

    def _box_cox(self, value: float) -> float:
        log_ratio = math.log(value / self.median)
        if self.power == 0:
            return log_ratio / self.variation
        return math.expm1(self.power * log_ratio) / (self.power * self.variation)

    def _inverse(self, z: float) -> float:
        if self.power == 0:
            return self.median * math.exp(self.variation * z)
        return self.median * math.exp(math.log1p(self.power * self.variation * z) / self.power)
