"""Base sections of all tasks, and sections that several tasks share."""

from typing import Annotated, Any

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.entries import Body, FreeJoint, Geom, Hinge, Steps
from mimoc.schema.quantities import Whole


class TaskSpec(Model):
    """A task: its goal, reward and termination."""

    kind: Any
    """Name of the task, as a `Literal`."""
    steps: Annotated[Whole, Field(ge=1, le=10**9)] | None = None
    """Control steps of an episode; by default as many as last as long as MIMo's task, and unlimited for `free`."""


class TaskEntry(Model):
    """What the runtime must know of a task."""

    kind: Any
    """Name of the task, as a `Literal`."""
    steps: Steps | None
    """Control steps after which an episode is truncated; None for never."""


class BallEntry(Model):
    """The ball of a task."""

    body: Body
    """Name of its body in the model."""
    joint: FreeJoint
    """Its free joint."""
    geom: Geom
    """Its only geom, a sphere."""


class GazeEntry(Model):
    """A joint that turns the head or an eye towards a target."""

    joint: Hinge
    """The hinge, which is locked at the angle that points the gaze at the target."""
    looker: Body
    """The body whose x axis is to point at the target."""
