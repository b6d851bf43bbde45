"""Typed reading of the keys of a flat configuration, and the spec that they are converted into."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any, TypeVar

from mimoc.base.errors import Problem, SpecError, suggestion
from mimoc.schema.base import shown
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS
from mimoc.schema.source import Source, dump

Meaning = TypeVar("Meaning")

MIMO_AGE_MONTHS = 18  # Age of MIMo's body (Mattern et al. 2024).

_FLAGS = {"yes": True, "no": False, "on": True, "off": False, "true": True, "false": False}
"""Words that YAML 1.1, used by most systems, reads as true and false; YAML 1.2, used here, has most of them as text."""


class Settings:
    """Reads the keys of a configuration and collects problems and notes."""

    def __init__(self, source: Source):
        self._source = source
        self._problems = list(source.problems)
        self._notes: list[Problem] = []
        self._read: set[str] = {str(path[0]) for path in source.invalid if path}
        self._data = {key: value for key, value in source.data.items() if key not in self._read}

    def find(self, *names: str) -> str | None:
        """Return which one of several synonymous keys is present, None if none is; more than one is a problem."""
        present = sorted((name for name in names if name in self._data), key=self.line)
        self._read.update(present)
        for other in present[1:]:
            message = f"same setting as '{present[0]}' in line {self.line(present[0])}; keep only one of the two"
            self._problems.append(self._source.problem((other,), message, at="key"))
        return present[0] if present else None

    def flag(self, *names: str) -> bool | None:
        """Return a boolean, None if the key is missing."""
        key = self.find(*names)
        if key is None:
            return None
        value = self._data[key]
        meaning = _FLAGS.get(value.lower(), value) if isinstance(value, str) else value
        if meaning in (True, False):
            return bool(meaning)
        return self._refuse(key, "is not true or false", "write true or false")

    def whole(self, *names: str, low: int, high: int) -> int | None:
        """Return an integer in a range, None if the key is missing."""
        return self._number(names, low, high, (int,), "a whole number")

    def number(self, *names: str, low: float, high: float) -> float | None:
        """Return a number in a range, None if the key is missing."""
        return self._number(names, low, high, (int, float), "a number")

    def choice(self, *names: str, meanings: Mapping[str, Meaning]) -> Meaning | None:
        """Return the meaning of a word, None if the key is missing; case, spaces and hyphens are ignored."""
        key = self.find(*names)
        if key is None:
            return None
        word = plain(self._data[key])
        if word in meanings:
            return meanings[word]
        return self._refuse(key, "is not a choice", suggestion(word[:80], meanings))

    def value(self, key: str) -> Any:
        """Return the value of a key, of any type."""
        return self._data[key]

    def keys(self, prefix: str) -> list[str]:
        """Return the keys with a prefix, in the order of their lines."""
        return [key for key in self._data if key.startswith(prefix)]

    def line(self, key: str) -> int:
        """Return the line of a key."""
        return self._source.locate((key,), at="key")[0]

    def note(self, key: str, message: str) -> None:
        """Add a note on a key."""
        self._read.add(key)
        self._notes.append(self._source.problem((key,), message, at="key"))

    def ignore(self, *prefixes: str) -> None:
        """Ignore the keys with these prefixes, which belong to something that is off."""
        self._read.update(key for key in self._data if key.startswith(prefixes))

    def unread_keys(self) -> list[str]:
        """Return the keys that have not been read."""
        return [key for key in self._data if key not in self._read]

    def notes(self) -> tuple[Problem, ...]:
        """Return the notes, by line, or raise a SpecError if there are problems; the error lists all of them."""
        if self._problems:
            raise SpecError(self._problems)
        return tuple(sorted(self._notes))

    def _number(self, names: Iterable[str], low: float, high: float, kinds: Iterable[type], what: str) -> Any:
        key = self.find(*names)
        if key is None:
            return None
        value, advice = self._data[key], f"give {low:g} to {high:.16g}"
        if type(value) not in kinds:
            return self._refuse(key, f"is not {what}", advice)
        return (
            value
            if low <= value <= high
            else self._refuse(key, f"is too {'small' if value < low else 'large'}", advice)
        )

    def _refuse(self, key: str, what: str, advice: str) -> None:
        value = self._data[key]
        wrong = "has no value" if value is None else f"{_as_written(value)} {what}"
        self._problems.append(self._source.problem((key,), f"{wrong}; {advice}"))


def named(groups: Iterable[str]) -> list[str]:
    """Return the shortest list of names for groups, in the order of the spec language: both arms are `arms`."""
    left = set(groups)
    names = set()
    for pair, sides in PAIRED_GROUPS.items():
        if set(sides) <= left:
            left -= set(sides)
            names.add(pair)
    return [name for name in STRENGTH_GROUPS if name in names | left]


def infant_name(stem: str, default: str) -> str:
    """Return a name for the infant, derived from the name of the file."""
    name = re.sub("[^a-z0-9]+", "_", stem.lower()).strip("_")
    return (name if name[:1].isalpha() else f"{default}_{name}")[:64].strip("_")


def plain(value: Any) -> str:
    """Return a word in normal form: lower case, with `_` as separator; None is `none`."""
    return "_".join(str("none" if value is None else value).lower().replace("-", " ").replace("_", " ").split())


def _as_written(value: Any) -> str:
    if isinstance(value, dict | list):
        return "this section" if isinstance(value, dict) else "this list"
    return f"'{shown(value)}'" if isinstance(value, str) else shown(str(value).lower())


@dataclass(frozen=True, slots=True)
class Imported:
    """A spec, with notes on the settings that it does not represent exactly."""

    system: str
    file: str  # File name of the configuration, as shown in messages.
    spec: dict[str, Any]  # The sections of the spec, in the order of writing.
    notes: tuple[Problem, ...]  # One note for each key without an exact counterpart, by line.
    scene: Callable[[str], Mapping[str, bytes]] | None = None
    """Returns the scene for the infant and its assets, for a spec whose file has some stem: content by path relative to
    the folder of the spec, the scene first."""
    sources: frozenset[Path] = frozenset()
    """Files that were read, besides the configuration itself; nothing is written there."""

    @property
    def text(self) -> str:
        """The content of the spec's YAML file, with the notes as comments; it has no path of this machine."""
        name = PurePath(self.file).name
        shown_name = name if name.isprintable() else ascii(name)[1:-1]
        heading = [f"# Converted from {self.system}'s {shown_name} by `mimoc import`."]
        if self.notes:
            heading.append("# Settings that this spec does not represent, or not exactly:")
        heading += [f"#   {self._place(note)}: {note.key}: {note.message}" for note in self.notes]
        return "\n".join((*heading, *(dump({key: value}).rstrip() for key, value in self.spec.items()), ""))

    def _place(self, note: Problem) -> str:
        file = "" if note.file == self.file else f"{ascii(PurePath(note.file).name)[1:-1]}, "
        return f"{file}line {note.line}"
