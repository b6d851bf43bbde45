"""When an infant has a reflex: its gain by age."""

from dataclasses import dataclass
from typing import Any

from mimoc.runtime.array_library import NUMPY


@dataclass(frozen=True, slots=True)
class AgeWindow:
    """The ages of onset and of loss, as the literature gives them: ranges over children, in months.

    No study gives gains by age. The law is ours: with an onset from a to b and a loss from c to d,

        gain(t) = clip((t - a) / (b - a), 0, 1) · clip((d - t) / (d - c / 2), 0, 1),

    so that a reflex rises from the earliest to the latest age of onset, is whole until half of the lower age of loss,
    and is gone at the upper.
    """

    onset_months: tuple[float, float] | None = None
    """None: whole at birth."""
    loss_months: tuple[float, float] | None = None
    """None: it stays."""

    def gain(self, age_months: Any) -> Any:
        """Return the gain at an age, or at ages, of NumPy: from 0 to 1."""
        gain = NUMPY.ones_like(age_months, dtype=float)
        if self.onset_months:
            first, last = self.onset_months
            gain = gain * NUMPY.clip((age_months - first) / (last - first), 0.0, 1.0)
        if self.loss_months:
            lower, upper = self.loss_months
            gain = gain * NUMPY.clip((upper - age_months) / (upper - lower / 2), 0.0, 1.0)
        return gain
