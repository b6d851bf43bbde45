"""No goal: the reward is zero, and episodes do not end."""

from typing import TYPE_CHECKING, Any, Literal

from mimoc.schema.entries import Steps
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import TaskEntry, TaskSpec

if TYPE_CHECKING:
    from mimoc.compiler.task_setup import TaskSetup
    from mimoc.runtime.task import Task


class FreeSpec(TaskSpec):
    """No goal: the reward is zero, and episodes do not end."""

    kind: Literal["free"]
    """Name of the task."""


class FreeEntry(TaskEntry):
    """No goal: the reward is zero, and episodes do not end."""

    kind: Literal["free"] = "free"
    """Name of the task."""
    steps: Steps | None = None
    """Control steps after which an episode is truncated; None for never."""


def build(spec: FreeSpec, tree: Any) -> "TaskSetup":
    """Return a setup that adds nothing."""
    from mimoc.compiler.task_setup import TaskSetup

    return TaskSetup(FreeEntry(steps=spec.steps))


def bind(entry: FreeEntry, model: Any, bundle: Any) -> "Task":
    """Return a task that only ends episodes."""
    from mimoc.runtime.task import Task

    return Task(entry.steps)


KIND = TaskKind("free", FreeSpec, FreeEntry, build, bind, poses=None)
