"""The `task` of a spec and of a manifest: one of the registered tasks."""

from functools import reduce
from operator import or_
from typing import Annotated, Any, cast

from pydantic import Field
from pydantic.fields import FieldInfo

from mimoc.schema.components.tasks import TASKS
from mimoc.schema.task_base import TaskEntry


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
    choice: Any = Annotated[reduce(or_, sections), Field(discriminator="kind")]
    field = Field(default=default, description=description)
    return FieldInfo.from_annotated_attribute(choice if default else choice | None, field)
