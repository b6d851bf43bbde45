"""No goal."""

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.components.tasks.free import FreeEntry
from mimoc.runtime.task import Task


def bind(entry: FreeEntry, model: mujoco.MjModel, bundle: Bundle) -> Task:
    """Return the task."""
    return Task(entry.steps)
