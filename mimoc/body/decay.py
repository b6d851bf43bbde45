"""How much of a newborn is left at an age."""

import math
from dataclasses import dataclass

from mimoc.body.part import REFERENCE_AGE_MONTHS


@dataclass(frozen=True, slots=True)
class Decay:
    """What is particular to newborns, and is gone at 18 months: a stretched exponential of age.

    The newborn share is (e(t) - e(18)) / (1 - e(18)) with e(t) = exp(-(t / tau)^power) and t the age in months: 1 at
    birth, 0 from 18 months on.
    """

    tau_months: float
    """Time constant: the older the infant when it is lost, the longer."""
    power: float
    """Steepness: 1 is a plain exponential, above 1 the loss begins slowly."""

    def __call__(self, age_months: float) -> float:
        """Return the newborn share, from 1 at birth to 0 at 18 months and later."""
        if age_months >= REFERENCE_AGE_MONTHS:
            return 0.0
        last = math.exp(-((REFERENCE_AGE_MONTHS / self.tau_months) ** self.power))
        return (math.exp(-((age_months / self.tau_months) ** self.power)) - last) / (1 - last)
