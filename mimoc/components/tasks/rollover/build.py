"""The setup of turning over: an infant lies as its scene says."""

from mimoc.body.tree import BodyTree
from mimoc.compiler.task_setup import TaskSetup
from mimoc.components.tasks.rollover import RolloverEntry, RolloverSpec

STEPS = 500
"""Of an episode (MIMo)."""


def build(task: RolloverSpec, tree: BodyTree) -> TaskSetup:
    """Return the setup of `rollover`, which any infant can play."""
    return TaskSetup(RolloverEntry(steps=task.steps or STEPS, hip=tree.bodies[0].name, reward=task.reward or "dense"))
