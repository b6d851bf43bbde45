"""How much smaller and fatter than others children are at term who were born early, and how they catch up.

At term, infants born at 30.0 weeks (SD 2.7) are 570 g and 3.8 cm smaller than those born at term, with heads smaller by
1 cm (Johnson, Wootton & Jackson 2011, Arch Dis Child 96, Suppl 1: Fa23, S): 1.3, 2 and .8 of WHO's standard deviations.
3 % more of their weight is fat (Johnson et al. 2012, Pediatrics 130: e640, S), which is gone at 3 months (24 and 25 %,
Hamatschek et al. 2020, Nutrients 12: 288, S; linear, D). For other gestations, and at other ages, sizes have the factor

    g(weeks) (1 - t)^2

with g from 0 at 37 weeks to 1 at 30 and 1.3 at 22 in straight lines (D), and the share t of the time from term to 24
months after birth that has passed: most of catching up comes in the first year (288 preterm infants, 0 to 24 months,
S), and by 24 months it is complete on average (D; it is not for all who were born very early or small).
"""

from collections.abc import Mapping

import numpy as np

from mimoc.base.units import DAYS_PER_MONTH
from mimoc.fits.curves import LAST_MONTH

Z_AT_TERM: Mapping[str, float] = {"length_cm": -2.0, "weight_kg": -1.3, "head_circumference_cm": -0.8}
"""By how many standard deviations of WHO's indicators infants born at 30 weeks differ at term from those of term."""
FAT_AT_TERM_PERCENT = 3.0  # How much more of their weight is fat, in percentage points.
AS_FAT_MONTHS = 3.0  # Corrected age from which on they are as fat as others.
WEEKS, SHARES = (37.0, 30.0, 22.0), (0.0, 1.0, 1.3)  # Shares of these differences in those born at so many weeks.
MONTHS_EARLY = tuple(7 * (40 - weeks) / DAYS_PER_MONTH for weeks in WEEKS)  # How long before 40 weeks that is.


def share(months_early: float, corrected_age_months: float) -> float:
    """Return how much of the differences of size at term, of those born at 30 weeks, a child has.

    Args:
        months_early: How long before 40 weeks it was born; 0 of one that was born at term.
        corrected_age_months: Its age since 40 weeks.
    """
    passed = corrected_age_months / (LAST_MONTH - months_early)
    return _at_term(months_early) * max(0.0, 1.0 - passed) ** 2


def more_fat_percent(months_early: float, corrected_age_months: float) -> float:
    """Return how much more of its weight is fat than of those born at term, in percentage points."""
    left = max(0.0, 1.0 - corrected_age_months / AS_FAT_MONTHS)
    return FAT_AT_TERM_PERCENT * _at_term(months_early) * left


def _at_term(months_early: float) -> float:
    return float(np.interp(months_early, MONTHS_EARLY, SHARES))
