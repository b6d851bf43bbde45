"""What can be asked of the task `catch`, and what the runtime must know of it."""

from typing import Literal

from mimoc.tasks.base import BallEntry, Range, TaskEntry, TaskSpec


class CatchSpec(TaskSpec):
    """Catch a ball that falls on the open hand."""

    kind: Literal["catch"]
    """Which task this is."""
    hand: Literal["right", "left"] | None = None
    """The hand that catches; left out, the right one."""


class CatchEntry(TaskEntry):
    """Catch a ball that falls on the open hand."""

    kind: Literal["catch"] = "catch"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    hand: tuple[str, ...]
    """The bodies that catch."""
    palm: str
    """The body over which the ball is dropped."""
    palm_m: tuple[float, float, float]
    """The point of it that the ball falls on, in its frame."""
    ball: BallEntry
    """What is to be caught."""
    radius_m: Range = (0.005, 0.025)
    """Of the ball, drawn for each episode (MIMo)."""
    mass_kg: Range = (0.05, 0.5)
    """Of the ball, drawn for each episode (MIMo)."""
    drop_m: Range
    """Height of the ball over the palm, drawn for each episode."""
    lost_m: float
    """How far below the palm or to its side the ball is lost."""
    held_steps: int = 100
    """Control steps of contact without a break that make a catch (MIMo)."""
    contact_reward: float = 1.0
    """For a step in contact (MIMo)."""
    effort_weight: float = 40.0
    """What effort costs (MIMo)."""
    success_reward: float = 100.0
    """For a catch, and what is lost with the ball (MIMo)."""
