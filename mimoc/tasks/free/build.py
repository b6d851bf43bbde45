"""No goal."""

from mimoc.body.tree import BodyTree
from mimoc.tasks.build_setup import TaskSetup
from mimoc.tasks.free import FreeEntry, FreeSpec


def build(spec: FreeSpec, tree: BodyTree) -> TaskSetup:
    """Return the setup of `free`, which adds nothing."""
    return TaskSetup(FreeEntry(steps=spec.steps))
