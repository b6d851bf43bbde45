"""Where the values of a spec were written, what the numbers of its task are, and where others' kinds come from."""

from collections.abc import Mapping
from typing import Any

from mimoc.body.origins import Entry
from mimoc.body.parts import PARTS
from mimoc.schema.infant import InfantSpec, to_data
from mimoc.schema.source import Source
from mimoc.tasks.base import TaskEntry

SPEC_FILE = "spec.yaml"
"""The spec in a bundle, as it was written."""


def trace_spec(spec: InfantSpec, written: Source) -> dict[str, Entry]:
    """Return where each value of the spec was written, by key; `spec.age_months`."""
    found = {}
    for path, value in _leaves(to_data(spec)):
        line, column = written.locate(path)
        rule = f"{SPEC_FILE}:{line}:{column}" if path in written.value_places else "default"
        found[".".join(("spec", *path))] = {"value": value, "rule": rule}
    return found


def _leaves(data: Mapping[str, Any], above: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    """Return the path and value of everything in nested data that is not a section."""
    found = []
    for key, value in data.items():
        path = (*above, key)
        found += _leaves(value, path) if isinstance(value, Mapping) else [(path, value)]
    return found


TASK_KEYS = ["spec.task.kind", "spec.age_months"]


def trace_task(entry: TaskEntry) -> dict[str, Entry]:
    """Return an entry for each number that the manifest tells of a task."""
    fields = type(entry).model_fields
    numbers = {name: value for name, value in entry.model_dump().items() if _is_number(value)}
    return {
        f"task.{entry.kind}.{name}": {"value": value, "rule": fields[name].description or "", "from": TASK_KEYS}
        for name, value in numbers.items()
    }


def _is_number(value: Any) -> bool:
    """Return whether a value is a number or some numbers."""
    values = value if isinstance(value, tuple) else (value,)
    return bool(values) and all(isinstance(each, int | float) for each in values)


PLUGIN_KEYS = {
    "actuation": ["spec.actuation.model"],
    "tasks": ["spec.task.kind"],
    "scenes": ["spec.scene.kind"],
    "toys": ["spec.scene.toys.source"],
}
"""Key of the spec that asks for a kind; a sense is a section, which has none of its own."""


def trace_plugins(plugins: Mapping[str, str]) -> dict[str, Entry]:
    """Return an entry for each kind that is not mimoc's own: the distribution that it comes from.

    Args:
        plugins: Distributions by kind, such as `senses.sound`; empty for a kind that a script registered.
    """
    return {f"plugins.{kind}": _plugin_entry(kind, distribution) for kind, distribution in plugins.items()}


def _plugin_entry(kind: str, distribution: str) -> Entry:
    rule = "the installed distribution that declares this kind" if distribution else "registered by a script"
    section, _, name = kind.partition(".")
    sources = PLUGIN_KEYS.get(section, [])
    if section == "parts":
        sources = ["spec.body.hands" if PARTS[name].replaces else "spec.body.extra"]
    return {"value": distribution, "rule": rule, "from": sources}
