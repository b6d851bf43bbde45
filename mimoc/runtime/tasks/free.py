"""No goal: an infant that may do as it likes."""

import mujoco

from mimoc.bundle import Bundle
from mimoc.runtime.fastenings import Fastenings
from mimoc.runtime.tasks.task import Task
from mimoc.schema.goals import FreeEntry


def bind(entry: FreeEntry, bundle: Bundle, model: mujoco.MjModel, fastenings: Fastenings) -> Task:
    """Return the task."""
    return Task(entry.steps)
