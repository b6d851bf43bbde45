"""The stage of turning over: an infant lies as its scene says."""

from mimoc.body import BodyTree
from mimoc.tasks.entries import RolloverEntry
from mimoc.tasks.setup import Stage
from mimoc.tasks.spec import TaskSpec

STEPS = 500
"""Of an episode (MIMo)."""


def stage_rollover(task: TaskSpec, tree: BodyTree) -> Stage:
    """Return the stage of `rollover`, which any infant can play."""
    return Stage(RolloverEntry(steps=task.steps or STEPS, hip=tree.bodies[0].name, reward=task.reward or "dense"))
