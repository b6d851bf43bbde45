"""What can be asked of the task `standup`, and what the runtime must know of it."""

from typing import Literal

from mimoc.tasks.base import TaskEntry, TaskSpec


class StandupSpec(TaskSpec):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"]
    """Which task this is."""


class StandupEntry(TaskEntry):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"] = "standup"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    head: str
    """The body that is to get up high."""
    base_m: float
    """Height of the head that earns nothing."""
    success_m: float
    """Height of the head of an infant that stands."""
    effort_weight: float = 0.01
    """What the sum of squared actions costs (MIMo)."""
