"""Standing up: get the head up high while holding on to a rail."""

from dataclasses import dataclass
from typing import Any

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.components.tasks.standup import StandupEntry
from mimoc.runtime.actuation import command_range
from mimoc.runtime.task import Judgement, SquaredCommands, Task
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds


@dataclass(frozen=True)
class Standup(Term):
    """The reward is the height of the head above a base, less what the commands cost.

    An infant that stands may go on.
    """

    head: int
    base_m: float
    success_m: float
    effort_weight: float
    cost: SquaredCommands

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants."""
        height_m = worlds.xpos[:, self.head, 2]
        terms = {"height": height_m - self.base_m, "effort": -self.effort_weight * self.cost(worlds, action)}
        return Judgement(terms, success=height_m >= self.success_m)


def bind(entry: StandupEntry, model: mujoco.MjModel, bundle: Bundle) -> Task:
    """Find what *entry* names in *model*."""
    cost = SquaredCommands(*command_range(bundle.manifest.actuation))
    head = model.body(entry.head).id
    return Task(entry.steps, Standup(head, entry.base_m, entry.success_m, entry.effort_weight, cost))
