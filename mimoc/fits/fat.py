"""Fat of healthy infants, as a share of their weight by age.

That of newborns is the mean of 87 three days old, 8.6 % (SD 3.7), by displacement of air (Roggero et al. 2009, Early
Hum Dev 85: 349, S); others found up to 11 % (Hawkes et al. 2011, S). Later means are close to those of Fomon et al.
1982 (Am J Clin Nutr 35: 1169), of boys and girls together, and the standard deviation is 5 in 26 % at 6 months and in
proportion at other ages, so that newborns vary less than measured: assumptions (M, D). Girls have slightly more fat
than boys (Breij et al. 2016, Pediatr Obes, 1 and 6 months, S); that is left out.
"""

import numpy as np

MONTHS = (0, 1, 2, 3, 4, 5, 6, 9, 12, 18, 24)
MEAN_PERCENT = (8.6, 15.7, 20.5, 23.5, 25.0, 25.7, 25.9, 24.5, 23.1, 21.3, 20.0)
"""At these ages, with straight lines in between."""
VARIATION = 0.19  # Standard deviation by mean.
LEAST_PERCENT = 1.0  # Least fat that an infant can have.


def mean_percent(age_months: float) -> float:
    """Return the mean share of fat in the weight, in [%]."""
    return float(np.interp(age_months, MONTHS, MEAN_PERCENT))


def percent(z: float, age_months: float) -> float:
    """Return the share of fat at *z* standard deviations, in [%]."""
    return mean_percent(age_months) * (1 + VARIATION * z)


def z_score(value_percent: float, age_months: float) -> float:
    """Return how many standard deviations a share of fat lies above the mean: the inverse of `percent`."""
    return (value_percent / mean_percent(age_months) - 1) / VARIATION
