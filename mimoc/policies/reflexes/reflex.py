"""What a reflex is: one record, with the ages at which there is one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mimoc.policies.reflexes.sensing import Sensed
from mimoc.runtime.array_library import NUMPY


@dataclass(frozen=True, slots=True)
class AgeWindow:
    """The ages of onset and of loss, as the literature gives them: ranges over children, in months.

    No study gives gains by age. The law is ours: with an onset from a to b and a loss from c to d,

        gain(t) = clip((t - a) / (b - a), 0, 1) · clip((d - t) / (d - c / 2), 0, 1),

    so that a reflex rises from the earliest to the latest age of onset, is whole until half of the lower age of loss,
    and is gone at the upper.
    """

    onset_months: tuple[float, float] | None = None  # None: whole at birth.
    loss_months: tuple[float, float] | None = None  # None: it stays.

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


State = Mapping[str, Any]  # What a reflex remembers of k infants: arrays of shape (k,), by name.
Drives = Mapping[str, Any]
"""How much of each movement (`mimoc.policies.reflexes.binding`) it commands, from 0 to 1, shape (k,)."""


@dataclass(frozen=True, slots=True)
class Reflex:
    """A reflex: when infants have it, what sets it off, and what it does."""

    name: str
    stimulus: str  # What sets it off, in a few words.
    response: str  # What the infant does then, in a few words.
    ages: AgeWindow
    senses: tuple[str, ...]  # The senses that it needs; without one of them, it does nothing.
    source: str
    """Where ages and response are from, and so how far they can be relied on; "memory" is still to be checked."""
    run: Callable[[Sensed, State], tuple[Drives, State]]
    """Returns the drives of a control step and what is remembered, for what is sensed. It does not branch on values: it
    runs on k infants at once, with NumPy or torch."""
    start: Mapping[str, float] = field(default_factory=dict)  # What is remembered when an episode begins.
