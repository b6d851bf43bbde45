"""Where each value of a spec was written."""

from collections.abc import Mapping
from typing import Any

from mimoc.body.origins import Entry
from mimoc.schema.infant import InfantSpec, to_data
from mimoc.schema.source import Source

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
