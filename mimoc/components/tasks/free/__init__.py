"""No goal: the reward is zero, and episodes do not end."""

from typing import Literal

from mimoc.schema.entries import Steps
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task_base import TaskEntry, TaskSpec


class FreeSpec(TaskSpec):
    """No goal: the reward is zero, and episodes do not end."""

    kind: Literal["free"]
    """Name of the task."""


class FreeEntry(TaskEntry):
    """No goal: the reward is zero, and episodes do not end."""

    kind: Literal["free"] = "free"
    """Name of the task."""
    steps: Steps | None = None
    """Control steps after which an episode is truncated; None for never."""


KIND = TaskKind(
    "free", FreeSpec, FreeEntry, "mimoc.components.tasks.free.build", "mimoc.components.tasks.free.run", poses=None
)
