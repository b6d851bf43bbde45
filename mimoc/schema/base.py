"""Base classes of all sections: frozen data with documented keys, some of which depend on registered components."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer
from pydantic.fields import FieldInfo

from mimoc.base.errors import KindError
from mimoc.base.kinds import Registry

KeyPath: TypeAlias = tuple[str | int, ...]  # Keys and indices that lead to a value.
Place: TypeAlias = tuple[int, int]  # Line and column, both from 1.


def dotted(path: KeyPath) -> str:
    """Return a path as a user would write it: `scene.room.size_m[0]`."""
    return "".join(f"[{step}]" if isinstance(step, int) else f".{shown(step)}" for step in path).removeprefix(".")


def shown(text: str) -> str:
    """Return a text shortened and escaped for one line of a message."""
    short = text if len(text) <= 40 else text[:37] + "..."
    return short if short.isprintable() else ascii(short)[1:-1]


class Model(BaseModel):
    """Base of every section: immutable, no unknown keys, documented fields."""

    # Validators are built when first used: most sections are only ever validated as part of a whole spec or manifest.
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, defer_build=True)

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """Yield what `repr` shows: the values that were given, without defaults."""
        yield from ((key, value) for key, value in super().__repr_args__() if key in self.model_fields_set)


def omitting(*names: str) -> Any:
    """Return a serializer of a section, for its class, that leaves out fields of some names which have their default.

    So what is rare makes no file longer, and no file different that was written before there was the field.
    """

    def serialized(self: BaseModel, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields, values = type(self).model_fields, serialize(self)
        usual = {name for name in names if getattr(self, name) == fields[name].get_default(call_default_factory=True)}
        return {key: value for key, value in values.items() if key not in usual}

    return model_serializer(mode="wrap")(serialized)


class KeyedError(ValueError):
    """The value of a key contradicts other keys of its section."""

    def __init__(self, key: KeyPath, message: str, *, against: KeyPath = ()):
        super().__init__(message)
        self.key = key
        """The wrong key, relative to the section."""
        self.against = against
        """The key that it contradicts, relative to the section; empty if there are several or none."""


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


Fields = Callable[[], Mapping[str, FieldInfo]]
M = TypeVar("M", bound=type[Model])

_FIELDS: dict[type[Model], Fields] = {}
"""Sections that depend on the registered kinds, innermost first, and the functions that return their fields."""
_COMPOSED: dict[type[Model], set[str]] = {}  # Names of the fields that were added to each section.
_WATCHERS: list[Callable[[], None]] = []


class ComposedModel(Model):
    """A section some of whose fields are named by the registered kinds, not in its class."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return the value of such a field."""


def composed(fields: Fields) -> Callable[[M], M]:
    """Return a decorator for a section with fields that depend on the registered kinds, and are made by a function."""

    def decorate(section: M) -> M:
        _FIELDS[section] = fields
        _compose(section, fields)
        return section

    return decorate


def recompose() -> None:
    """Compose all sections again, after a kind was added or removed."""
    for section, fields in _FIELDS.items():
        _compose(section, fields)
        section.model_rebuild(force=True)
    for watcher in _WATCHERS:
        watcher()


def on_recompose(watcher: Callable[[], None]) -> None:
    """Register a function to be called after every recomposition, such as one that clears a cache."""
    _WATCHERS.append(watcher)


def described_field(annotation: Any, default: Any, about: str) -> FieldInfo:
    """Return a field with its type, which may be annotated, its default and its description."""
    return FieldInfo.from_annotated_attribute(annotation, Field(default=default, description=about))


def section_field(section: type[Model]) -> FieldInfo:
    """Return a field for an optional section; its description is the first line of the section's docstring."""
    return described_field(section | None, None, _first_line(section))


def own_sections(kinds: Registry[Any]) -> dict[str, FieldInfo]:
    """Return a field for each kind that has a section of its own keys, under the name of the kind."""
    return {
        kind.name: FieldInfo(annotation=kind.spec, default_factory=kind.spec, description=_first_line(kind.spec))
        for kind in kinds.values()
        if kind.spec
    }


def _first_line(section: type[Model]) -> str:
    return (section.__doc__ or "").split("\n")[0]


def choice_field(kinds: Registry[Any], default: str, about: str) -> FieldInfo:
    """Return a field that names one of the registered kinds."""
    return described_field(Literal[tuple(kinds)], default, about)


def _compose(section: type[Model], fields: Fields) -> None:
    options = fields()
    if taken := section in _COMPOSED and (options.keys() & section.model_fields.keys()) - _COMPOSED[section]:
        raise KindError(f"'{min(taken)}' is already another key of {section.__name__}; choose another name")
    for name in _COMPOSED.get(section, set()) - options.keys():
        del section.__annotations__[name], section.model_fields[name]
    _COMPOSED[section] = set(options)
    for name, info in options.items():
        section.__annotations__[name] = info.annotation
        section.model_fields[name] = info
