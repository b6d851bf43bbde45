"""No goal: an infant that may do as it likes."""

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.runtime.fastenings import Fastenings
from mimoc.tasks.free.spec import FreeEntry
from mimoc.tasks.task import Task


def bind(entry: FreeEntry, bundle: Bundle, model: mujoco.MjModel, fastenings: Fastenings) -> Task:
    """Return the task."""
    return Task(entry.steps)
