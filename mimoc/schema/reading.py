"""Validation of the data of a YAML file: returns the spec, or reports all problems at once."""

from collections.abc import Iterator
from itertools import takewhile
from typing import Any, TypeVar

from pydantic import PrivateAttr, ValidationError

from mimoc.base.errors import SpecError
from mimoc.schema.base import KeyPath, Model
from mimoc.schema.outline import Language, language_of
from mimoc.schema.source import Source
from mimoc.schema.wording import fault, missing_value

Spec = TypeVar("Spec", bound=Model)


class FileModel(Model):
    """What a file says; it knows the file that it was read from."""

    _source: Source | None = PrivateAttr(default=None)

    @property
    def source(self) -> Source | None:
        """The file this was read from, or None if it was created in Python."""
        return self._source

    def model_post_init(self, context: Any) -> None:
        """Store the source, which is passed as the context of validation."""
        if isinstance(context, Source):
            self._source = context


def read_keys(keys: type[Spec], source: Source) -> Spec:
    """Return the spec, or another kind of file, that the class *keys* describes.

    Invalid values are reported and removed, and the rest is validated again, because pydantic runs the validators of
    a section only once each of its keys is valid.

    Raises:
        SpecError: If the spec is invalid; the error lists all problems.
    """
    language = language_of(keys)
    empty = (path for path in _empty(source.data, language) if path not in source.invalid)
    faults = {path: missing_value(path, language) for path in empty}
    data = _repaired(source.data, {*source.invalid, *faults}, language)
    spec = None
    while spec is None:
        try:
            spec = keys.model_validate(data, context=source)
        except ValidationError as error:
            latest = [fault(details, data, language) for details in error.errors(include_url=False)]
            known = {path[:depth] for path in {*source.invalid, *faults} for depth in range(len(path) + 1)}
            faults |= {new.path: new for new in reversed(latest) if not {new.path, new.against or new.path} & known}
            before, data = data, _repaired(data, {new.path for new in latest}, language)
            if data == before:
                break
    if spec is None or source.problems or faults:
        reported = (source.problem(wrong.path, wrong.message, at=wrong.at) for wrong in faults.values())
        raise SpecError([*source.problems, *reported])
    return spec


def _empty(value: Any, language: Language, path: KeyPath = ()) -> Iterator[KeyPath]:
    """Yield the paths of all known keys and items without a value."""
    if value is None and language.is_known(path):
        yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for step, item in items:
        yield from _empty(item, language, (*path, step))


def _repaired(data: dict[str, Any], paths: set[KeyPath], language: Language) -> dict[str, Any]:
    """Return data without the values at some paths, or with examples in their place where a key is required."""
    for keys in sorted({_keys(path) for path in paths} - {()}):
        section = keys[:-1]
        if keys[-1] in language.outline(section).schema.get("required", ()):
            data = _replaced(data, keys, language.outline(keys).example)
        elif keys[-1] in _section(data, section):
            data = _replaced(data, keys, None)
        elif section:
            data = _replaced(data, section, None)
    return data


def _keys(path: KeyPath) -> tuple[str, ...]:
    """Return a path up to the first list."""
    return tuple(map(str, takewhile(lambda step: isinstance(step, str), path)))


def _section(data: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else None
    return data if isinstance(data, dict) else {}


def _replaced(data: Any, keys: tuple[str, ...], value: Any) -> Any:
    """Return data with one value replaced, or removed if the new value is None."""
    if not isinstance(data, dict):
        return data
    first, *deeper = keys
    if deeper:
        value = _replaced(data.get(first, {}), tuple(deeper), value)
    rest = {key: item for key, item in data.items() if key != first}
    return rest if value is None else {**rest, first: value}
