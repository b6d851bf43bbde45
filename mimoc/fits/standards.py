"""What children are compared with: WHO's growth standards, fat of healthy infants, and how preterm infants differ.

**Fat**, as a share of weight by age. That of newborns is the mean of 87 three days old, 8.6 % (SD 3.7), by displacement
of air (Roggero et al. 2009, Early Hum Dev 85: 349, S); others found up to 11 % (Hawkes et al. 2011, S). Later means are
close to those of Fomon et al. 1982 (Am J Clin Nutr 35: 1169), of boys and girls together, and the standard deviation is
5 in 26 % at 6 months and in proportion at other ages, so that newborns vary less than measured: assumptions (M, D).
Girls have slightly more fat than boys (Breij et al. 2016, Pediatr Obes, 1 and 6 months, S); that is left out.

**Preterm infants** who were born at 30.0 weeks (SD 2.7) are at term 570 g and 3.8 cm smaller than others, with heads
smaller by 1 cm (Johnson, Wootton & Jackson 2011, Arch Dis Child 96, Suppl 1: Fa23, S): 1.3, 2 and .8 of WHO's standard
deviations. 3 % more of their weight is fat (Johnson et al. 2012, Pediatrics 130: e640, S), which is gone at 3 months
(24 and 25 %, Hamatschek et al. 2020, Nutrients 12: 288, S; linear, D). For other gestations, and at other ages, the
differences of size have the factor

    g(weeks) (1 - t)^2

with g from 0 at 37 weeks to 1 at 30 and 1.3 at 22 in straight lines (D), and the share t of the time from term to 24
months after birth that has passed: most of catching up comes in the first year (288 preterm infants, 0 to 24 months,
S), and by 24 months it is complete on average (D; it is not for all who were born very early or small).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.units import DAYS_PER_MONTH, months_to_days
from mimoc.fits.curves import LAST_MONTH

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


FAT_MONTHS = (0, 1, 2, 3, 4, 5, 6, 9, 12, 18, 24)
MEAN_FAT_PERCENT = (8.6, 15.7, 20.5, 23.5, 25.0, 25.7, 25.9, 24.5, 23.1, 21.3, 20.0)
"""At these ages, with straight lines in between."""
FAT_VARIATION = 0.19  # Standard deviation by mean.
MIN_FAT_PERCENT = 1.0  # Least fat that an infant can have.


def mean_fat_percent(age_months: float) -> float:
    """Return the mean share of fat in the weight, in [%]."""
    return float(np.interp(age_months, FAT_MONTHS, MEAN_FAT_PERCENT))


def fat_percent(z: float, age_months: float) -> float:
    """Return the share of fat at *z* standard deviations, in [%]."""
    return mean_fat_percent(age_months) * (1 + FAT_VARIATION * z)


def fat_z_score(value_percent: float, age_months: float) -> float:
    """Return how many standard deviations a share of fat lies above the mean: the inverse of `fat_percent`."""
    return (value_percent / mean_fat_percent(age_months) - 1) / FAT_VARIATION


PRETERM_Z_AT_TERM: Mapping[str, float] = {"length_cm": -2.0, "weight_kg": -1.3, "head_circumference_cm": -0.8}
"""By how many standard deviations of WHO's indicators infants born at 30 weeks differ at term from those of term."""
FAT_AT_TERM_PERCENT = 3.0  # How much more of their weight is fat, in percentage points.
AS_FAT_MONTHS = 3.0  # Corrected age from which on they are as fat as others.
WEEKS, PRETERM_SHARES = (
    (37.0, 30.0, 22.0),
    (0.0, 1.0, 1.3),
)  # Shares of these differences in those born at so many weeks.
MONTHS_EARLY = tuple(7 * (40 - weeks) / DAYS_PER_MONTH for weeks in WEEKS)  # How long before 40 weeks that is.


def preterm_share(months_early: float, corrected_age_months: float) -> float:
    """Return how much of the differences of size at term, of those born at 30 weeks, a child has.

    Args:
        months_early: How long before 40 weeks it was born; 0 of one that was born at term.
        corrected_age_months: Its age since 40 weeks.
    """
    passed = corrected_age_months / (LAST_MONTH - months_early)
    return _share_at_term(months_early) * max(0.0, 1.0 - passed) ** 2


def more_fat_percent(months_early: float, corrected_age_months: float) -> float:
    """Return how much more of its weight is fat than of those born at term, in percentage points."""
    left = max(0.0, 1.0 - corrected_age_months / AS_FAT_MONTHS)
    return FAT_AT_TERM_PERCENT * _share_at_term(months_early) * left


def _share_at_term(months_early: float) -> float:
    return float(np.interp(months_early, MONTHS_EARLY, PRETERM_SHARES))
