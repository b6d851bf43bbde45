"""A spec: read from a file or written in Python, and changed."""

from pathlib import Path
from typing import Any, Self

from pydantic import PrivateAttr

from mimoc.plugins import load_plugins
from mimoc.schema.composition import composed
from mimoc.schema.plain import changed, everything, given
from mimoc.schema.reading import read_keys
from mimoc.schema.source import Source, in_memory, in_memory_as_text
from mimoc.schema.spec import InfantKeys
from mimoc.tasks.spec import task_field

HERE = Path()


@composed(lambda: {"task": task_field()})
class InfantSpec(InfantKeys):
    """One infant in one world, as a user wrote it: nothing is computed, and what was left out has its default."""

    _source: Source | None = PrivateAttr(default=None)

    @property
    def source(self) -> Source | None:
        """The file this was read from, None where it was written in Python."""
        return self._source

    def with_(self, **changes: Any) -> Self:
        """Return a spec with some keys changed, checked like one that is read from a file.

        All else stays as it was written, and paths are still seen from the folder of the file it was read from. A
        dictionary changes the keys of a section that it names; a section as an object replaces the whole section;
        None takes a key or a section back to its default.

            spec.with_(age_months=9.5, body={"hands": "five_finger"}, senses={"touch": None})
            spec.with_(body=BodySpec(expression="happy"), task=None)

        Args:
            changes: New values, by key of the spec.

        Raises:
            SpecError: If anything is wrong with the new spec, with all that is, by key.
        """
        data = self._source.data if self._source and _says(self._source, self) else given(self)
        return _checked(type(self), changed(data, changes), self)

    def __eq__(self, other: object) -> bool:
        """Say whether two specs say the same, wherever they were read from."""
        return isinstance(other, InfantSpec) and self.__dict__ == other.__dict__

    def model_post_init(self, context: Any) -> None:
        """Remember the source, which is passed as the context of validation."""
        if isinstance(context, Source):
            self._source = context


def read_spec(source: Source) -> InfantSpec:
    """Return the spec that a file holds.

    Raises:
        SpecError: If anything is wrong with it, with all that is.
    """
    return read_keys(InfantSpec, source)


def to_data(spec: InfantSpec) -> dict[str, Any]:
    """Return a spec as plain data with every default in place, which reads back as an equal spec.

    A key without a value, such as a sense that is off, is left out.
    """
    return spec.model_dump(mode="json", exclude_none=True)


def validated(spec: InfantSpec) -> InfantSpec:
    """Return a spec that has passed validation, which `model_copy` and `model_construct` go without.

    Raises:
        SpecError: If it does not pass, with all that is wrong, by key.
    """
    found = read_spec(in_memory(everything(spec), _name(spec), _folder(spec)))
    return spec if found == spec else _checked(InfantSpec, given(spec), spec)


def as_written(spec: InfantSpec) -> Source:
    """Return the file a spec was read from, or, if it was made or changed in Python, what a file would say of it."""
    if spec.source and _says(spec.source, spec):
        return spec.source
    return in_memory_as_text(given(spec), _name(spec), _folder(spec))


def _checked(kind: type[Any], data: dict[str, Any], before: InfantSpec) -> Any:
    """Return the spec that data make: first as it is, for it may hold what cannot be written."""
    place = _name(before), _folder(before)
    read_keys(kind, in_memory(data, *place))
    return read_keys(kind, in_memory_as_text(data, *place))


def _says(source: Source, spec: InfantSpec) -> bool:
    """Say whether a file still says what the spec does that was read from it."""
    return read_spec(source) == spec


def _name(spec: InfantSpec) -> str:
    return f"<{spec.__dict__.get('name', 'spec')}>"


def _folder(spec: InfantSpec) -> Path:
    return spec.source.folder if spec.source else HERE


load_plugins()
