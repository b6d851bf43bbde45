"""Fat of healthy infants, as a share of their weight by age.

The means are those of Fomon et al. 1982 (Am J Clin Nutr 35: 1169), of boys and girls together, and the spread is that of
infants at 6 months, 5 in 26 % (both M); that it is in proportion at other ages is an assumption (D). Girls have slightly
more fat than boys (Breij et al. 2016, 1 and 6 months, S), which is left out: WHO found no difference between the
milestones of girls and boys that would call for it.
"""

import numpy as np

MEAN_PERCENT = {
    **{0: 14.3, 1: 15.7, 2: 20.5, 3: 23.5, 4: 25.0, 5: 25.7, 6: 25.9},
    **{9: 24.5, 12: 23.1, 18: 21.3, 24: 20.0},
}
"""By age in months, with straight lines in between."""
VARIATION = 0.19
"""Standard deviation by mean."""
LEAST_PERCENT = 1.0
"""Least fat that an infant can have."""


def mean_percent(age_months: float) -> float:
    """Return the mean share of fat in the weight, in [%]."""
    return float(np.interp(age_months, [*MEAN_PERCENT], [*MEAN_PERCENT.values()]))


def percent(z: float, age_months: float) -> float:
    """Return the share of fat at *z* standard deviations, in [%]."""
    return mean_percent(age_months) * (1 + VARIATION * z)


def z_score(value_percent: float, age_months: float) -> float:
    """Return how many standard deviations a share of fat lies above the mean: the inverse of `percent`."""
    return (value_percent / mean_percent(age_months) - 1) / VARIATION
