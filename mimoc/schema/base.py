"""What every section of a spec has in common."""

from pydantic import BaseModel, ConfigDict

from mimoc.source import KeyPath


class Model(BaseModel):
    """Base of every section: immutable, no unknown keys, documented fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class KeyedError(ValueError):
    """A key of a section that does not go with the rest of it."""

    def __init__(self, key: KeyPath, message: str, *, against: KeyPath = ()):
        super().__init__(message)
        self.key = key
        """Where it is wrong, relative to the section."""
        self.against = against
        """What it does not go with, relative to the section; empty where that is several keys or none."""
