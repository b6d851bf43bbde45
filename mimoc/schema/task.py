"""The `task` of a spec and of a manifest: base sections of all tasks, and the field that holds one of them."""

from functools import reduce
from operator import or_
from typing import Annotated, Any, cast

from pydantic import Field
from pydantic.fields import FieldInfo

from mimoc.schema.base import Model
from mimoc.schema.entries import Body, FreeJoint, Geom, Hinge, Steps
from mimoc.schema.kinds import TASKS
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


def task_field() -> FieldInfo:
    """Return the field `task` of a spec."""
    return _one_of([kind.spec for kind in TASKS.values()], None, "The task; by default, none.")


def task_entry_field() -> FieldInfo:
    """Return the field `task` of a manifest."""
    return _one_of([kind.entry for kind in TASKS.values()], no_task(), "The task.")


def no_task() -> TaskEntry:
    """Return what a manifest says of an infant without a task."""
    return cast(TaskEntry, TASKS["free"].entry())


def _one_of(sections: list[Any], default: Any, description: str) -> FieldInfo:
    """Return a field that holds one of several sections, identified by its `kind`."""
    section: Any = Annotated[reduce(or_, sections), Field(discriminator="kind")]
    annotation = section | None if default is None else section
    return FieldInfo.from_annotated_attribute(annotation, Field(default=default, description=description))
