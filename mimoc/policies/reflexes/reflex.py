"""What a reflex is: one record."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mimoc.policies.reflexes.ages import AgeWindow
from mimoc.policies.reflexes.sensing import Sensed

State = Mapping[str, Any]
"""What a reflex remembers of k infants: arrays of shape (k,), by name."""
Drives = Mapping[str, Any]
"""How much of each movement (`mimoc.policies.reflexes.movements`) it commands, from 0 to 1, shape (k,)."""


@dataclass(frozen=True, slots=True)
class Reflex:
    """A reflex: when infants have it, what sets it off, and what it does."""

    name: str
    """Name, such as `palmar_grasp`."""
    stimulus: str
    """What sets it off, in a few words."""
    response: str
    """What the infant does then, in a few words."""
    ages: AgeWindow
    """When infants have it."""
    senses: tuple[str, ...]
    """The senses that it needs; without one of them, it does nothing."""
    source: str
    """Where ages and response are from, and so how far they can be relied on; "memory" is still to be checked."""
    run: Callable[[Sensed, State], tuple[Drives, State]]
    """Returns the drives of a control step and what is remembered, for what is sensed. It does not branch on values: it
    runs on k infants at once, with NumPy or torch."""
    start: Mapping[str, float] = field(default_factory=dict)
    """What is remembered when an episode begins."""
