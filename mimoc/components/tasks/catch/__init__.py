"""Catch a ball that falls on the open hand."""

from typing import Literal

from mimoc.schema.entries import Amount, Body, Length, Lengths, Number, Steps
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import BallEntry, TaskEntry, TaskSpec


class CatchSpec(TaskSpec):
    """Catch a ball that falls onto the open hand."""

    kind: Literal["catch"]
    """Name of the task."""
    hand: Literal["left", "right"] | None = None
    """The hand that catches; by default, the right one."""


class CatchEntry(TaskEntry):
    """Catch a ball that falls onto the open hand."""

    kind: Literal["catch"] = "catch"
    """Name of the task."""
    hand: tuple[Body, ...]
    """Bodies of the hand that catches."""
    palm: Body
    """The body over which the ball is dropped."""
    palm_m: tuple[Number, Number, Number]
    """The point that the ball falls onto, in the frame of that body."""
    ball: BallEntry
    """The ball."""
    radius_m: Lengths = (0.005, 0.025)
    """Range of the ball's radius, drawn for each episode (MIMo)."""
    mass_kg: tuple[Length, Length] = (0.05, 0.5)
    """Range of the ball's mass, drawn for each episode (MIMo)."""
    drop_m: Lengths
    """Range of the ball's initial height over the palm, drawn for each episode."""
    lost_m: Amount
    """Distance below the palm or to its side beyond which the ball counts as lost."""
    held_steps: Steps = 100
    """Consecutive control steps of contact that count as a catch; 1 s (MIMo)."""
    contact_reward: Number = 1.0
    """Reward for a step in contact (MIMo)."""
    effort_weight: Number = 40.0
    """Weight of the cost of effort (MIMo)."""
    success_reward: Number = 100.0
    """Reward for a catch; losing the ball costs as much (MIMo)."""


KIND = TaskKind(
    "catch",
    CatchSpec,
    CatchEntry,
    "mimoc.components.tasks.catch.build",
    "mimoc.components.tasks.catch.run",
    scenes=("flat", "crib", "room"),
)
