"""What can be asked of the task `selfbody`, and what the runtime must know of it."""

from typing import Literal

from mimoc.schema.base import Model
from mimoc.tasks.base import TaskEntry, TaskSpec


class SelfbodySpec(TaskSpec):
    """Touch the part of the own body that the observation names."""

    kind: Literal["selfbody"]
    """Which task this is."""
    hand: Literal["right", "left"] | None = None
    """The hand that touches; left out, the right one."""


class TargetEntry(Model):
    """A part of the body that is to be touched."""

    name: str
    """What it is called in the goal."""
    bodies: tuple[str, ...]
    """What belongs to it."""


class SelfbodyEntry(TaskEntry):
    """Touch a part of oneself."""

    kind: Literal["selfbody"] = "selfbody"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    fingers: str
    """The body whose distance to what is to be touched counts."""
    effectors: tuple[str, ...]
    """The bodies that touch."""
    targets: tuple[TargetEntry, ...]
    """What is to be touched, one of them in each episode; the observation `goal` has a number for each."""
    success_reward: float = 500.0
    """For touching it (MIMo)."""
    idle_reward: float = -1.0
    """For a step in which nothing is touched (MIMo)."""
