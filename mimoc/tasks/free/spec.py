"""What can be asked of the task `free`, and what the runtime must know of it."""

from typing import Literal

from mimoc.tasks.base import TaskEntry, TaskSpec


class FreeSpec(TaskSpec):
    """No goal: the reward is zero, and episodes do not end."""

    kind: Literal["free"]
    """Which task this is."""


class FreeEntry(TaskEntry):
    """No goal at all."""

    kind: Literal["free"] = "free"
    """Which task this is."""
    steps: int | None = None
    """Control steps of an episode; None is no end."""
