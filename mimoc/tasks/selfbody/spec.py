"""The options of the task `selfbody`, and its entry in the manifest."""

from typing import Literal

from mimoc.schema.base import Model
from mimoc.tasks.base import TaskEntry, TaskSpec


class SelfbodySpec(TaskSpec):
    """Touch the part of its own body that the observation `goal` names."""

    kind: Literal["selfbody"]
    """Name of the task."""
    hand: Literal["right", "left"] | None = None
    """The hand that touches; by default, the right one."""


class TargetEntry(Model):
    """A part of the body that can be the goal of an episode."""

    name: str
    """Name of the part."""
    bodies: tuple[str, ...]
    """Bodies that belong to it."""


class SelfbodyEntry(TaskEntry):
    """Touch the part of its own body that the observation `goal` names."""

    kind: Literal["selfbody"] = "selfbody"
    """Name of the task."""
    steps: int | None
    """Control steps after which an episode is truncated; None for never."""
    fingers: str
    """The body whose distance to the target is rewarded."""
    effectors: tuple[str, ...]
    """The bodies whose contact with the target counts."""
    targets: tuple[TargetEntry, ...]
    """The targets, one of which is drawn for each episode; the observation `goal` has an entry for each."""
    success_reward: float = 500.0
    """Reward for touching the target (MIMo)."""
    idle_reward: float = -1.0
    """Reward of a step in which nothing is touched (MIMo)."""
