"""Conversion of sections of a spec to plain data, and changes to that data."""

from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from mimoc.schema.base import Model


def given(section: Model) -> dict[str, Any]:
    """Return the explicitly given values of a section as plain data, without defaults."""
    unknown = section.__dict__.keys() - type(section).model_fields.keys()
    explicit = section.model_fields_set | unknown
    return {key: plain(value) for key, value in section.__dict__.items() if key in explicit and value is not None}


def everything(section: Model) -> dict[str, Any]:
    """Return all values of a section as plain data, including defaults and unknown keys."""
    values = {key: value for key, value in section.__dict__.items() if value is not None}
    return {key: everything(value) if isinstance(value, Model) else plain(value) for key, value in values.items()}


def changed(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return data with changes applied: a dictionary is merged into the existing section, None removes a key.

    Any other value, including a section given as an object, replaces the existing value.
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
    """Return a value in the types of YAML where possible: NumPy numbers as Python numbers, sets as lists."""
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
