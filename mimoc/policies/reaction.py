"""Reactions: what is new is reacted to only after an infant has decided, some time after it could be sensed."""

import math
from collections import deque
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest

T = TypeVar("T")
SIGHT = "vision"
LEAST_S = 0.02
"""No single decision is quicker."""


@dataclass
class Chance:
    """The generator of the policy whose reactions are drawn, as soon as it has acted."""

    generator: np.random.Generator | None = None

    @property
    def drawn_from(self) -> np.random.Generator:
        """The generator, which a policy gets before anything is drawn."""
        assert self.generator is not None, "a policy sets it in each call, before its behaviours see anything"
        return self.generator


@dataclass
class Reaction(Generic[T]):
    """Stimuli that are still to be reacted to, the earliest first.

    With a conduction time c, mean decision m and variation v, a stimulus at time t is reacted to at t + c + d, where d
    is drawn from a log-normal distribution of mean m and standard deviation v m; never before an earlier one is.

    Example:
        >>> import numpy as np
        >>> from mimoc.policies.reaction import Reaction
        >>> reaction = Reaction[str](conduction_s=0.1, mean_s=0.3, variation=0.0)
        >>> reaction.see("a ball", 1.0, np.random.default_rng(0))
        >>> reaction.at(1.39), reaction.at(1.4 + 1e-9)
        (None, 'a ball')
    """

    conduction_s: float
    """From a stimulus until it could be decided on."""
    mean_s: float
    """Mean of a decision."""
    variation: float
    """Its standard deviation, as a share of the mean."""
    _due: deque[tuple[float, T]] = field(default_factory=deque)
    _reacted: T | None = None

    def begin(self) -> None:
        """Forget all stimuli."""
        self._due.clear()
        self._reacted = None

    def see(self, stimulus: T, time_s: float, generator: np.random.Generator) -> None:
        """Take a new stimulus; when it is reacted to is drawn now."""
        due_s = time_s + self.conduction_s + self._decision_s(generator)
        self._due.append((max([due_s, *(earlier_s for earlier_s, _ in self._due)]), stimulus))

    def at(self, time_s: float) -> T | None:
        """Return the stimulus that was reacted to last by now; None before the first."""
        while self._due and self._due[0][0] <= time_s:
            self._reacted = self._due.popleft()[1]
        return self._reacted

    def _decision_s(self, generator: np.random.Generator) -> float:
        spread = math.sqrt(math.log1p(self.variation**2))
        return max(LEAST_S, self.mean_s * math.exp(spread * generator.standard_normal() - spread**2 / 2))


def reaction_of(manifest: Manifest, response: str) -> Reaction[int] | None:
    """Return the reaction of an infant by `look` or `reach`, or None if it decides at once (`delays.processing`)."""
    delays = dict(manifest.delays)
    processing = manifest.delays.processing
    if processing is None:
        return None
    mean_ms, variation = (getattr(processing, f"{response}_{what}") for what in ("ms", "variation"))
    return Reaction(ms_to_s(delays[SIGHT].ms), ms_to_s(mean_ms), variation)
