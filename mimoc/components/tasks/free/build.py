"""No goal."""

from mimoc.body.tree import BodyTree
from mimoc.compiler.task_setup import TaskSetup
from mimoc.components.tasks.free import FreeEntry, FreeSpec


def build(spec: FreeSpec, tree: BodyTree) -> TaskSetup:
    """Return the setup of `free`, which adds nothing."""
    return TaskSetup(FreeEntry(steps=spec.steps))
