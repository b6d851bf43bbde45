"""What every section of a spec has in common, and positions in its file: a path of keys, or a line and column."""

from collections.abc import Iterator
from typing import Any, TypeAlias

from pydantic import BaseModel, ConfigDict

KeyPath: TypeAlias = tuple[str | int, ...]
Place: TypeAlias = tuple[int, int]
"""Line and column, both from 1."""


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


class KeyedError(ValueError):
    """The value of a key contradicts other keys of its section."""

    def __init__(self, key: KeyPath, message: str, *, against: KeyPath = ()):
        super().__init__(message)
        self.key = key
        """The wrong key, relative to the section."""
        self.against = against
        """The key that it contradicts, relative to the section; empty if there are several or none."""
