"""No goal: an infant that may do as it likes."""

from collections.abc import Callable

import mujoco
import numpy as np

from mimoc.bundle import Bundle
from mimoc.runtime.fastenings import Fastenings
from mimoc.runtime.tasks.task import Task, Verdict
from mimoc.schema.goals import FreeEntry

NOTHING_EARNED = Verdict({})


class Free(Task):
    """A world without a goal."""

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return that nothing is earned."""
        return NOTHING_EARNED


def bind(entry: FreeEntry, bundle: Bundle, model: mujoco.MjModel, fastenings: Fastenings) -> Free:
    """Return the task."""
    return Free(entry.steps)
