"""The options of the task `catch`, and its entry in the manifest."""

from typing import Literal

from mimoc.tasks.base import BallEntry, Range, TaskEntry, TaskSpec


class CatchSpec(TaskSpec):
    """Catch a ball that falls onto the open hand."""

    kind: Literal["catch"]
    """Name of the task."""
    hand: Literal["right", "left"] | None = None
    """The hand that catches; by default, the right one."""


class CatchEntry(TaskEntry):
    """Catch a ball that falls onto the open hand."""

    kind: Literal["catch"] = "catch"
    """Name of the task."""
    steps: int | None
    """Control steps after which an episode is truncated; None for never."""
    hand: tuple[str, ...]
    """Bodies of the hand that catches."""
    palm: str
    """The body over which the ball is dropped."""
    palm_m: tuple[float, float, float]
    """The point that the ball falls onto, in the frame of that body."""
    ball: BallEntry
    """The ball."""
    radius_m: Range = (0.005, 0.025)
    """Range of the ball's radius, drawn for each episode (MIMo)."""
    mass_kg: Range = (0.05, 0.5)
    """Range of the ball's mass, drawn for each episode (MIMo)."""
    drop_m: Range
    """Range of the ball's initial height over the palm, drawn for each episode."""
    lost_m: float
    """Distance below the palm or to its side beyond which the ball counts as lost."""
    held_steps: int = 100
    """Consecutive control steps of contact that count as a catch (MIMo)."""
    contact_reward: float = 1.0
    """Reward for a step in contact (MIMo)."""
    effort_weight: float = 40.0
    """Weight of the cost of effort (MIMo)."""
    success_reward: float = 100.0
    """Reward for a catch; losing the ball costs as much (MIMo)."""
