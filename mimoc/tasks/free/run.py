"""No goal: an infant that may do as it likes."""

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.tasks.free.spec import FreeEntry
from mimoc.tasks.task import Task


def bind(entry: FreeEntry, model: mujoco.MjModel, bundle: Bundle) -> Task:
    """Return the task."""
    return Task(entry.steps)
