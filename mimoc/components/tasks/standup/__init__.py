"""Stand up, holding on to a rail."""

from typing import Literal

from mimoc.schema.entries import Body, Number
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import TaskEntry, TaskSpec


class StandupSpec(TaskSpec):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"]
    """Name of the task."""


class StandupEntry(TaskEntry):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"] = "standup"
    """Name of the task."""
    head: Body
    """The body whose height is rewarded."""
    base_m: Number
    """Height of the head at which the reward for height is zero."""
    success_m: Number
    """Height of the head that counts as standing."""
    effort_weight: Number = 0.01
    """Weight of the sum of squared actions, as a cost in the reward (MIMo)."""


KIND = TaskKind(
    "standup",
    StandupSpec,
    StandupEntry,
    "mimoc.components.tasks.standup.build",
    "mimoc.components.tasks.standup.run",
    scenes=("flat",),
)
