"""What each task makes of an infant and its world."""

from collections.abc import Callable, Mapping

from mimoc.body import BodyTree
from mimoc.tasks.catch.build import stage_catch
from mimoc.tasks.free.build import stage_free
from mimoc.tasks.reach.build import stage_reach
from mimoc.tasks.rollover.build import stage_rollover
from mimoc.tasks.selfbody.build import stage_selfbody
from mimoc.tasks.setup import Hold, Stage
from mimoc.tasks.spec import TaskSpec
from mimoc.tasks.standup.build import stage_standup

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
