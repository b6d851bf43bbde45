"""Sections of a spec as plain data, whatever they hold, and changes of that data."""

from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from mimoc.schema.base import Model


def given(section: Model) -> dict[str, Any]:
    """Return what was said of a section as plain data; what was left to its default is left out."""
    unknown = section.__dict__.keys() - type(section).model_fields.keys()
    said = section.model_fields_set | unknown
    return {key: plain(value) for key, value in section.__dict__.items() if key in said and value is not None}


def everything(section: Model) -> dict[str, Any]:
    """Return all that a section holds as plain data, defaults and what does not belong there included."""
    values = {key: value for key, value in section.__dict__.items() if value is not None}
    return {key: everything(value) if isinstance(value, Model) else plain(value) for key, value in values.items()}


def changed(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return data with changes: dictionaries go into the section that is there, None takes a key out.

    All else, a section as an object included, replaces what is there.
    """
    kept = {key: value for key, value in data.items() if changes.get(key, value) is not None}
    for key, value in changes.items():
        if isinstance(value, Mapping):
            before = kept.get(key)
            kept[str(key)] = changed(before if isinstance(before, Mapping) else {}, value)
        elif value is not None:
            kept[str(key)] = plain(value)
    return kept


def plain(value: Any) -> Any:
    """Return a value as YAML would have it, if it can be: NumPy's numbers as Python's, sets as lists."""
    if isinstance(value, Model):
        return given(value)
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, set | frozenset):
        return sorted(map(plain, value), key=str)
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, PurePath):
        return str(value)
    return value.tolist() if hasattr(value, "tolist") else value
