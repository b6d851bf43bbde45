"""Touch the part of the own body that the observation names."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.entries import Body, Label, Number
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import TaskEntry, TaskSpec


class SelfbodySpec(TaskSpec):
    """Touch the part of its own body that the observation `goal` names."""

    kind: Literal["selfbody"]
    """Name of the task."""
    hand: Literal["left", "right"] | None = None
    """The hand that touches; by default, the right one."""


class TargetEntry(Model):
    """A part of the body that can be the goal of an episode."""

    name: Label
    """Name of the part."""
    bodies: tuple[Body, ...]
    """Bodies that belong to it."""


class SelfbodyEntry(TaskEntry):
    """Touch the part of its own body that the observation `goal` names."""

    kind: Literal["selfbody"] = "selfbody"
    """Name of the task."""
    fingers: Body
    """The body whose distance to the target is rewarded."""
    effectors: tuple[Body, ...]
    """The bodies whose contact with the target counts."""
    targets: Annotated[tuple[TargetEntry, ...], Field(min_length=1)]
    """The targets, one of which is drawn for each episode; the observation `goal` has an entry for each."""
    success_reward: Number = 500.0
    """Reward for touching the target (MIMo)."""
    idle_reward: Number = -1.0
    """Reward of a step in which nothing is touched (MIMo)."""


KIND = TaskKind(
    "selfbody",
    SelfbodySpec,
    SelfbodyEntry,
    "mimoc.components.tasks.selfbody.build",
    "mimoc.components.tasks.selfbody.run",
    step_ms=5.0,
)
