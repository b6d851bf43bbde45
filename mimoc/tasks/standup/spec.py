"""The options of the task `standup`, and its entry in the manifest."""

from typing import Literal

from mimoc.tasks.base import TaskEntry, TaskSpec


class StandupSpec(TaskSpec):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"]
    """Name of the task."""


class StandupEntry(TaskEntry):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"] = "standup"
    """Name of the task."""
    steps: int | None
    """Control steps after which an episode is truncated; None for never."""
    head: str
    """The body whose height is rewarded."""
    base_m: float
    """Height of the head at which the reward for height is zero."""
    success_m: float
    """Height of the head that counts as standing."""
    effort_weight: float = 0.01
    """Weight of the sum of squared actions, as a cost in the reward (MIMo)."""
