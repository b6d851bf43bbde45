"""The stage of a world without a goal."""

from mimoc.body import BodyTree
from mimoc.tasks.entries import FreeEntry
from mimoc.tasks.setup import Stage
from mimoc.tasks.spec import TaskSpec

FREE = Stage(FreeEntry())
"""Without an end."""


def stage_free(task: TaskSpec, tree: BodyTree) -> Stage:
    """Return the stage of `free`."""
    return Stage(FreeEntry(steps=task.steps))
