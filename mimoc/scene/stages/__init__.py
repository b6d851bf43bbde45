"""What each task makes of an infant and its world."""

from collections.abc import Callable, Mapping

from mimoc.body import BodyTree
from mimoc.scene.stages.catch import stage_catch
from mimoc.scene.stages.free import stage_free
from mimoc.scene.stages.reach import stage_reach
from mimoc.scene.stages.rollover import stage_rollover
from mimoc.scene.stages.selfbody import stage_selfbody
from mimoc.scene.stages.stage import Hold, Stage
from mimoc.scene.stages.standup import stage_standup
from mimoc.schema.tasks import TaskSpec

STAGES: Mapping[str, Callable[[TaskSpec, BodyTree], Stage]] = {
    "reach": stage_reach,
    "catch": stage_catch,
    "rollover": stage_rollover,
    "standup": stage_standup,
    "selfbody": stage_selfbody,
    "free": stage_free,
}
"""By kind of task; each raises UnplayableError if the infant lacks what it needs."""

__all__ = ["STAGES", "Hold", "Stage"]
