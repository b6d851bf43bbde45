"""Standing up: get the head up high while holding on to a rail."""

from collections.abc import Callable

import mujoco
import numpy as np

from mimoc.actuation.spec import ActuationEntry
from mimoc.bundle.io import Bundle
from mimoc.tasks.standup.spec import StandupEntry
from mimoc.tasks.task import SquaredCommands, Task, Verdict


class StandupTask(Task):
    """An infant at a rail; the reward is the more, the higher its head is and the less it commands."""

    def __init__(self, entry: StandupEntry, actuation: ActuationEntry, model: mujoco.MjModel):
        """Find the head in *model*."""
        super().__init__(entry.steps)
        self._entry = entry
        self._cost = SquaredCommands(actuation)
        self._head = model.body(entry.head).id

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return what the head's height earns and the commands cost; an infant that stands may go on."""
        entry, height_m = self._entry, float(data.xpos[self._head, 2])
        terms = {"height": height_m - entry.base_m, "effort": -entry.effort_weight * self._cost(action)}
        return Verdict(terms, success=height_m >= entry.success_m)


def bind(entry: StandupEntry, model: mujoco.MjModel, bundle: Bundle) -> StandupTask:
    """Find what *entry* names in *model*."""
    return StandupTask(entry, bundle.manifest.actuation, model)
