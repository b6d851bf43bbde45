"""The options of the task `free`, and its entry in the manifest."""

from typing import Literal

from mimoc.schema.entries import Steps
from mimoc.tasks.base import TaskEntry, TaskSpec


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
