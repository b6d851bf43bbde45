"""Sections of the spec language and of the manifest that are composed from what each kind declares."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import Field
from pydantic.fields import FieldInfo

from mimoc.base.errors import KindError
from mimoc.base.kinds import Kinds
from mimoc.schema.base import Model

Fields = Callable[[], Mapping[str, FieldInfo]]
M = TypeVar("M", bound=type[Model])

_FIELDS: dict[type[Model], Fields] = {}
"""Sections that depend on the registered kinds, innermost first, and the functions that return their fields."""
_COMPOSED: dict[type[Model], set[str]] = {}
"""Names of the fields that were added to each section."""
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


def own_sections(kinds: Kinds[Any]) -> dict[str, FieldInfo]:
    """Return a field for each kind that has a section of its own keys, under the name of the kind."""
    return {
        kind.name: FieldInfo(annotation=kind.spec, default_factory=kind.spec, description=_first_line(kind.spec))
        for kind in kinds.values()
        if kind.spec
    }


def _first_line(section: type[Model]) -> str:
    return (section.__doc__ or "").split("\n")[0]


def choice_field(kinds: Kinds[Any], default: str, about: str) -> FieldInfo:
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
