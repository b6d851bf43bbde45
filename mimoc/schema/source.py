"""The contents of a YAML file: its data, and the line of every value."""

import re
import stat
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import IO, Any, Literal, NoReturn

from mimoc.base.errors import Problem, SpecError
from mimoc.schema.base import KeyPath, Place, dotted
from mimoc.schema.yaml_document import UNPRINTABLE, DocumentReader, dump

MAX_BYTES = 2**20

_BINARY = "this is not a text file; a spec is YAML text"


@dataclass(frozen=True)
class FileKind:
    """The expected kind of file, for error messages."""

    name: str
    needs: str
    """Its required keys."""
    line: str
    """An example of a line."""


SPEC = FileKind("spec", "mimoc, name and age_months", "mimoc: 1")


@dataclass(frozen=True, repr=False)
class Source:
    """The contents of a YAML file: its data, and the line and column of each value."""

    file: str
    """Name of the file in messages."""
    text: str
    """The unchanged text: `text.encode()` gives the bytes of the file."""
    data: dict[str, Any]
    problems: tuple[Problem, ...]
    """Problems found while parsing, such as a repeated key or a NaN; they must be reported together with others."""
    invalid: frozenset[KeyPath]
    """Paths at which the data differs from the file because of those problems."""
    key_places: Mapping[KeyPath, Place]
    value_places: Mapping[KeyPath, Place]
    folder: Path
    """Relative paths in it are relative to this folder."""
    has_lines: bool = True
    """Whether there is a file with lines; problems of data from Python name keys only."""
    inside: KeyPath = ()
    """Path of the section of a larger file that this is, which messages name."""

    def __repr__(self) -> str:
        """Return name and size only: the text may be long."""
        return f"Source({self.file!r}, {len(self.text.splitlines())} lines)"

    def locate(self, path: KeyPath, *, at: Literal["key", "value"] = "value") -> Place:
        """Return the line and column of a key or its value, or of the closest enclosing key that is in the file."""
        if path in self.value_places:
            return (self.key_places if at == "key" else self.value_places)[path]
        while path not in self.key_places:
            path = path[:-1]
        return self.key_places[path]

    def problem(self, path: KeyPath, message: str, *, at: Literal["key", "value"] = "value") -> Problem:
        """Return a problem located at a key of this file, or at its value."""
        place = self.locate(path, at=at) if self.has_lines else (0, 0)
        return Problem(self.file, *place, dotted((*self.inside, *path)), message)

    def section(self, *keys: str) -> "Source":
        """Return a section of this file as if it were a file of its own."""
        data: Any = self.data
        for key in keys:
            data = data[key]

        def below(places: Mapping[KeyPath, Place]) -> dict[KeyPath, Place]:
            return {path[len(keys) :]: place for path, place in places.items() if path[: len(keys)] == keys}

        invalid = frozenset(path[len(keys) :] for path in self.invalid if path[: len(keys)] == keys)
        return replace(
            self,
            data=data,
            problems=(),
            invalid=invalid,
            key_places={(): (1, 1), **below(self.key_places)},
            value_places=below(self.value_places),
            inside=(*self.inside, *keys),
        )


def read(path: str | Path, kind: FileKind = SPEC) -> Source:
    """Read a YAML file, or raise a SpecError; messages say which kind of file was expected."""
    try:
        status = Path(path).stat()
        if stat.S_ISDIR(status.st_mode):
            _refuse(path, "this is a folder; give the path of the YAML file in it")
        if not stat.S_ISREG(status.st_mode):
            _refuse(path, f"this is a pipe or a device; write the {kind.name} to a file and give its path")
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        _refuse(path, "the file does not exist; check the path")
    except PermissionError:
        _refuse(path, "the file may not be read; check its permissions")
    except (OSError, ValueError) as error:  # ValueError: a path with a NUL in it.
        reason = (isinstance(error, OSError) and error.strerror) or str(error)
        _refuse(path, f"the file cannot be read ({reason}); check the path")
    if len(content) > MAX_BYTES:
        size_mib = max(status.st_size, len(content)) / MAX_BYTES
        limit = f"at most 1 MiB is allowed; check that it is a {kind.name}"
        _refuse(path, f"the file has {size_mib:.1f} MiB, but {limit}")
    return parse(content, str(path), kind)


def read_stream(stream: IO[bytes], name: str, kind: FileKind = SPEC) -> Source:
    """Read YAML from a pipe, to its end, as `read`; relative paths in it are relative to the current folder."""
    content = stream.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        _refuse(name, f"the input is larger than 1 MiB; check that it is a {kind.name}")
    return parse(content, name, kind)


def parse(text: bytes | str, file: str, kind: FileKind = SPEC) -> Source:
    """Read the text of a YAML file, or raise a SpecError: one YAML 1.2 document, a mapping at the top."""
    written = text if isinstance(text, str) else _decoded(text, file)
    plain = written.removeprefix("\ufeff")
    if "\0" in plain:
        _refuse(file, _BINARY)
    strange = [
        Problem(file, *_end(plain[: match.start()]), "", f"the character {match[0]!a} is not text; remove it")
        for match in islice(UNPRINTABLE.finditer(plain), 10)
    ]
    if strange:
        raise SpecError(strange)
    reader = DocumentReader(plain, file)
    data = reader.document()
    if data is None:
        _refuse(file, f"the file is empty; a {kind.name} needs at least {kind.needs}")
    if not isinstance(data, dict):
        message = f"this is not a mapping; write 'key: value' lines, such as '{kind.line}'"
        reader.stop((), reader.value_places[()], message)
    places = (reader.key_places, reader.value_places)
    folder = Path(file).parent
    return Source(file, written, data, tuple(reader.problems), frozenset(reader.invalid), *places, folder)


def in_memory(data: dict[str, Any], name: str, folder: Path) -> Source:
    """Return data from Python as if it had been read from a file; it may hold what YAML cannot express."""
    return Source(name, "", data, (), frozenset(), {(): (1, 1)}, {}, folder, has_lines=False)


def in_memory_as_text(data: dict[str, Any], name: str, folder: Path) -> Source:
    """Return data from Python together with the YAML text that mimoc writes for it."""
    return replace(parse(dump(data), name), folder=folder, has_lines=False)


def _end(text: str) -> Place:
    lines = re.split("\r\n|\r|\n", text)
    return (len(lines), len(lines[-1]) + 1)


def _decoded(content: bytes, file: str) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        if content.startswith((b"\xff\xfe", b"\xfe\xff")):
            _refuse(file, "this is UTF-16 text; save it as UTF-8")
        if b"\0" in content:
            _refuse(file, _BINARY)
        place = _end(content[: error.start].decode())
        message = f"the byte 0x{content[error.start]:02x} is not UTF-8 text; save the file as UTF-8"
        raise SpecError([Problem(file, *place, "", message)]) from None


def _refuse(file: str | Path, message: str) -> NoReturn:
    """Raise the error for a file that cannot be used at all."""
    raise SpecError([Problem(str(file), 1, 1, "", message)]) from None
