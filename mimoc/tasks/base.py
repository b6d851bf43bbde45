"""What all tasks declare."""

from typing import Annotated, Any

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.quantities import Whole

Range = tuple[float, float]
"""Lowest and highest value."""


class TaskSpec(Model):
    """A task: its goal, reward and termination."""

    kind: Any
    """Which task this is: a `Literal` of its name."""
    steps: Annotated[Whole, Field(ge=1, le=10**9)] | None = None
    """Control steps of an episode; left out, as many as MIMo's task has, and `free` has no end."""


class TaskEntry(Model):
    """What the runtime must know of a task."""

    kind: Any
    """Which task this is: a `Literal` of its name."""
    steps: int | None
    """Control steps after which an episode is truncated; None is never."""


class BallEntry(Model):
    """A ball that a task is about."""

    body: str
    """Its body in the model."""
    joint: str
    """Its free joint."""
    geom: str
    """Its one geom, a sphere."""


class GazeEntry(Model):
    """A joint of the head or an eye that turns to what is looked at."""

    joint: str
    """The hinge, which is locked at the angle that looks there."""
    looker: str
    """The body whose x axis is to point there."""
