"""A spec that was made of another system's configuration."""

from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from mimoc.errors import Problem
from mimoc.schema.yaml_scalars import dump


@dataclass(frozen=True, slots=True)
class Imported:
    """A spec, and what the configuration says that the spec does not."""

    system: str
    """Whose configuration it is, as people write it."""
    file: str
    """The configuration, as messages show it."""
    spec: dict[str, Any]
    """Section by section, in the order to write them in."""
    notes: tuple[Problem, ...]
    """One for each key that has no counterpart, or none that is quite the same; by line."""

    @property
    def text(self) -> str:
        """The spec as a YAML file, with the notes as comments; it does not say which folder they come from."""
        return "\n".join((*self._heading(), *(dump({key: value}).rstrip() for key, value in self.spec.items()), ""))

    def _heading(self) -> list[str]:
        made = f"# Made of {self.system}'s {_one_line(PurePath(self.file).name)} by `mimoc import`."
        if not self.notes:
            return [made]
        said = [f"#   line {note.line}: {note.key}: {note.message}" for note in self.notes]
        return [made, "# What it says and this spec does not, or not quite:", *said]


def _one_line(text: str) -> str:
    return text if text.isprintable() else ascii(text)[1:-1]
