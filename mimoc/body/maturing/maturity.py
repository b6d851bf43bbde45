"""How much of a newborn is left at an age."""

import math
from dataclasses import dataclass
from functools import lru_cache

from mimoc.body.anatomy import REFERENCE_AGE_MONTHS


@dataclass(frozen=True, slots=True)
class Decay:
    """What is particular to newborns, and is gone at 18 months: a stretched exponential of age."""

    tau_months: float
    """Time constant: the older the infant when it is lost, the longer."""
    power: float
    """Steepness: 1 is a plain exponential, above 1 the loss begins slowly."""

    def __call__(self, age_months: float) -> float:
        """Return the newborn share, from 1 at birth to 0 at 18 months and later."""
        return newborn_share(age_months, self.tau_months, self.power)


@lru_cache(maxsize=256)
def newborn_share(age_months: float, tau_months: float, power: float) -> float:
    """Return what is left of a newborn's property at an age: 1 at birth, 0 from 18 months on.

    It is exp(-(age / tau)^power), shifted and scaled so that it ends at 18 months exactly.
    """
    if age_months >= REFERENCE_AGE_MONTHS:
        return 0.0
    last = math.exp(-((REFERENCE_AGE_MONTHS / tau_months) ** power))
    return (math.exp(-((age_months / tau_months) ** power)) - last) / (1 - last)
