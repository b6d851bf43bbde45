"""What every section of a spec has in common."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ConfigDict

from mimoc.schema.key_paths import KeyPath


class Model(BaseModel):
    """Base of every section: immutable, no unknown keys, documented fields."""

    # Validators are built when first used: most sections are only ever validated as part of a whole spec or manifest.
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, defer_build=True)

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """Yield what `repr` shows: the values that were given, without defaults."""
        yield from ((key, value) for key, value in super().__repr_args__() if key in self.model_fields_set)


class KeyedError(ValueError):
    """The value of a key contradicts other keys of its section."""

    def __init__(self, key: KeyPath, message: str, *, against: KeyPath = ()):
        super().__init__(message)
        self.key = key
        """The wrong key, relative to the section."""
        self.against = against
        """The key that it contradicts, relative to the section; empty if there are several or none."""
