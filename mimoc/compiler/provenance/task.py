"""What each number of a task is, and what it follows from."""

from typing import Any

from mimoc.body.origins import Entry
from mimoc.tasks.base import TaskEntry

SOURCES = ["spec.task.kind", "spec.age_months"]


def trace_task(entry: TaskEntry) -> dict[str, Entry]:
    """Return an entry for each number that the manifest tells of a task."""
    fields = type(entry).model_fields
    numbers = {name: value for name, value in entry.model_dump().items() if _is_number(value)}
    return {
        f"task.{entry.kind}.{name}": {"value": value, "rule": fields[name].description or "", "from": SOURCES}
        for name, value in numbers.items()
    }


def _is_number(value: Any) -> bool:
    """Return whether a value is a number or some numbers."""
    values = value if isinstance(value, tuple) else (value,)
    return bool(values) and all(isinstance(each, int | float) for each in values)
