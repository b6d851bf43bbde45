"""The options of the task `standup`, and its entry in the manifest."""

from typing import Literal

from mimoc.schema.entries import Body, Number, Steps
from mimoc.tasks.base import TaskEntry, TaskSpec


class StandupSpec(TaskSpec):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"]
    """Name of the task."""


class StandupEntry(TaskEntry):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"] = "standup"
    """Name of the task."""
    steps: Steps | None
    """Control steps after which an episode is truncated; None for never."""
    head: Body
    """The body whose height is rewarded."""
    base_m: Number
    """Height of the head at which the reward for height is zero."""
    success_m: Number
    """Height of the head that counts as standing."""
    effort_weight: Number = 0.01
    """Weight of the sum of squared actions, as a cost in the reward (MIMo)."""
