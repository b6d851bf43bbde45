"""A spec converted from another system's configuration."""

from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from mimoc.errors import Problem
from mimoc.schema.yaml_document import dump


@dataclass(frozen=True, slots=True)
class Imported:
    """A spec, with notes on the settings that it does not represent exactly."""

    system: str
    """Name of the other system."""
    file: str
    """File name of the configuration, as shown in messages."""
    spec: dict[str, Any]
    """The sections of the spec, in the order of writing."""
    notes: tuple[Problem, ...]
    """One note for each key without an exact counterpart, by line."""

    @property
    def text(self) -> str:
        """The content of the spec's YAML file, with the notes as comments; it has no path of this machine."""
        return "\n".join((*self._heading(), *(dump({key: value}).rstrip() for key, value in self.spec.items()), ""))

    def _heading(self) -> list[str]:
        title = f"# Converted from {self.system}'s {_one_line(PurePath(self.file).name)} by `mimoc import`."
        if not self.notes:
            return [title]
        notes = [f"#   line {note.line}: {note.key}: {note.message}" for note in self.notes]
        return [title, "# Settings that this spec does not represent, or not exactly:", *notes]


def _one_line(text: str) -> str:
    return text if text.isprintable() else ascii(text)[1:-1]
