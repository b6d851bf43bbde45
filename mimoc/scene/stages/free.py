"""The stage of a world without a goal."""

from mimoc.body import BodyTree
from mimoc.scene.stages.stage import Stage
from mimoc.schema.goals import FreeEntry
from mimoc.schema.tasks import TaskSpec

FREE = Stage(FreeEntry())
"""Without an end."""


def stage_free(task: TaskSpec, tree: BodyTree) -> Stage:
    """Return the stage of `free`."""
    return Stage(FreeEntry(steps=task.steps))
