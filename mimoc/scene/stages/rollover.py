"""The stage of turning over: an infant lies as its scene says."""

from mimoc.body import BodyTree
from mimoc.scene.stages.stage import Stage
from mimoc.schema.goals import RolloverEntry
from mimoc.schema.tasks import TaskSpec

STEPS = 500
"""Of an episode (MIMo)."""


def stage_rollover(task: TaskSpec, tree: BodyTree) -> Stage:
    """Return the stage of `rollover`, which any infant can play."""
    return Stage(RolloverEntry(steps=task.steps or STEPS, hip=tree.bodies[0].name, reward=task.reward or "dense"))
