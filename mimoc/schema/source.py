"""The contents of a YAML file: its data, and the line of every value."""

import re
import stat
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import IO, Any, Literal, NoReturn

import yaml

from mimoc.base.errors import Problem, SpecError
from mimoc.schema.base import KeyPath, Place, dotted, shown

_INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_REAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_CONSTANTS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def scalar(text: str) -> bool | int | float | str | None:
    """Return what an unquoted YAML 1.2 scalar means: `012` is twelve, `1e-3` a number, `no` a word.

    Raises:
        ValueError: If it is a number that is not finite or too large.
    """
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _NOT_FINITE.fullmatch(text):
        raise ValueError(f"{text} is not finite; write a finite number")
    if not _REAL.fullmatch(text) and not _INTEGER.fullmatch(text):
        return text
    try:
        number = int(text, {"0o": 8, "0x": 16}.get(text[:2], 10)) if _INTEGER.fullmatch(text) else float(text)
        finite = abs(float(number)) <= sys.float_info.max
    except (OverflowError, ValueError):  # ValueError: Python does not convert integers of very many digits.
        number, finite = 0, False
    if not finite:
        raise ValueError(f"{shown(text)} is too large; write a smaller number")
    return number


def means_itself(text: str) -> bool:
    """Return whether an unquoted scalar is just this text."""
    try:
        return scalar(text) == text
    except ValueError:
        return False


def dump(data: Mapping[str, Any]) -> str:
    """Return data as YAML that parses to the same, with sorted keys."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=True, default_flow_style=False, width=sys.maxsize)


class _Dumper(yaml.SafeDumper):
    """PyYAML's dumper, without aliases and with quotes around words that YAML 1.2 would not read as text."""

    def ignore_aliases(self, data: Any) -> bool:
        return True

    def represent_word(self, text: str) -> yaml.ScalarNode:
        style = None if means_itself(text) else "'"
        return self.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _Dumper.represent_word)


MAX_VALUES = 5_000
"""Largest number of values in one file, with every alias expanded; a spec with every key has some 300."""
MAX_DEPTH = 20  # Largest depth of nested sections; the spec language needs five.

UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
"""Characters that YAML does not allow in a file."""
_SYNTAX = {
    "found character '\\t'": "a tab in the indentation, where YAML requires spaces; replace it with spaces",
    "that cannot start any token": "a value cannot start with this character; put the value in quotes",
    "mapping values are not allowed": "a second ':' on one line, or a key further in than its neighbours; "
    "line the keys up, and put text that holds ': ' in quotes",
    "could not find expected ':'": "this line is neither a key nor a value; write 'key: value'",
    "expected <block end>": "this line is not in line with those above it; give the keys of a section one indentation",
    "expected ',' or ']'": "this list is not closed; separate its values with ',' and close it with ']'",
    "expected ',' or '}'": "this section is not closed; separate its keys with ',' and close it with '}'",
    "found unexpected end of stream": "this quotation is not closed; end it with the same quote",
    "found unknown escape character": "an unknown escape after '\\'; put the text in single quotes",
    "sequence entries are not allowed": "a list cannot start here; start it on its own line, or write [a, b]",
}
"""Messages of PyYAML's scanner and parser, and the message shown instead, which says what to do."""
_OTHER_SYNTAX = "this is not YAML; look for a quote, a bracket, a colon or an indentation that is wrong"


class DocumentReader:
    """Builds the data of one document from its events, and collects problems."""

    def __init__(self, text: str, file: str):
        self.file = file
        self.events = yaml.SafeLoader(text)
        """Only its events are taken: nothing is resolved or constructed."""
        self.problems: list[Problem] = []
        self.invalid: set[KeyPath] = set()
        self.key_places: dict[KeyPath, Place] = {}
        self.value_places: dict[KeyPath, Place] = {}
        self.anchors: dict[str, tuple[Any, int] | None] = {}
        """Value and size of each; None while it is being read."""
        self.size = 0

    def document(self) -> Any:
        """Return the data of the file's only document, or None if the file is empty."""
        try:
            self.events.get_event()  # The stream starts.
            if not self.events.check_event(yaml.DocumentStartEvent):
                return None
            self.events.get_event()
            data = self._value((), self.events.get_event())
            self.events.get_event()  # The document ends.
            if self.events.check_event(yaml.DocumentStartEvent):
                self.stop((), _place(self.events.peek_event()), "a second document; write only one infant to a file")
        except yaml.MarkedYAMLError as error:
            raise SpecError([*self.problems, _syntax_problem(error, self.file)]) from None
        except (ValueError, OverflowError):  # PyYAML lets escapes through that are no characters: "\\UFFFFFFFF".
            mark = self.events.get_mark()
            message = "this escape sequence is not a character; write the character itself"
            self.stop((), (mark.line + 1, mark.column + 1), message)
        return data

    def stop(self, path: KeyPath, place: Place, message: str) -> NoReturn:
        """Raise the error with all problems found so far."""
        self._note(path, place, message)
        raise SpecError(self.problems)

    def _note(self, path: KeyPath, place: Place, message: str) -> None:
        self.problems.append(Problem(self.file, *place, dotted(path), message))

    def _note_invalid(self, path: KeyPath, place: Place, message: str) -> None:
        self._note(path, place, message)
        self.invalid.add(path)

    def _value(self, path: KeyPath, event: Any) -> Any:
        place = self.value_places[path] = _place(event)
        self.key_places.setdefault(path, place)
        self._count(1, place)
        size_before = self.size
        if isinstance(event, yaml.AliasEvent):
            return self._repeated(path, event.anchor, place)
        if event.tag is not None:
            tag = shown(event.tag.replace("tag:yaml.org,2002:", "!!"))
            self._note_invalid(path, place, f"the tag {tag} is not allowed; write the value without it")
        if event.anchor is not None:
            self.anchors[event.anchor] = None
        if isinstance(event, yaml.ScalarEvent):
            value = self._scalar(path, event)
        elif len(path) >= MAX_DEPTH:
            self._stop_too_deep(place)
        else:
            value = self._list(path) if isinstance(event, yaml.SequenceStartEvent) else self._mapping(path)
        if event.anchor is not None:
            self.anchors[event.anchor] = (value, 1 + self.size - size_before)
        return value

    def _scalar(self, path: KeyPath, event: Any) -> Any:
        try:
            if event.implicit[0]:
                return scalar(event.value)
            if UNPRINTABLE.search(event.value):
                raise ValueError("an escape sequence in this text is not a printable character; remove it")
        except ValueError as error:
            self._note_invalid(path, _place(event), str(error))
        return event.value

    def _repeated(self, path: KeyPath, name: str, place: Place) -> Any:
        anchored = self.anchors.get(name)
        if anchored is None:
            what = "is inside its own anchor" if name in self.anchors else f"has no '&{shown(name)}' before it"
            self._note_invalid(path, place, f"the alias '*{shown(name)}' {what}; write the value out")
            return None
        value, size = anchored
        self._count(size, place)
        return value

    def _list(self, path: KeyPath) -> list[Any]:
        values = []
        while not isinstance(event := self.events.get_event(), yaml.CollectionEndEvent):
            values.append(self._value((*path, len(values)), event))
        return values

    def _mapping(self, path: KeyPath) -> dict[str, Any]:
        values: dict[str, Any] = {}
        while not isinstance(event := self.events.get_event(), yaml.CollectionEndEvent):
            key = self._key(path, event)
            if key is None:
                self._skip(self.events.get_event())
            elif key in values:
                line = self.key_places[(*path, key)][0]
                message = f"repeated key, already given in line {line}; keep one of the two"
                self._note((*path, key), _place(event), message)
                self._skip(self.events.get_event())
            else:
                self.key_places[(*path, key)] = _place(event)
                values[key] = self._value((*path, key), self.events.get_event())
        return values

    def _key(self, path: KeyPath, event: Any) -> str | None:
        """Return a key, None if it cannot be one."""
        if not isinstance(event, yaml.ScalarEvent):
            self._skip(event)
            self._note(path, _place(event), "a key is missing or is not a word; write keys such as 'age_months'")
        elif event.implicit[0] and event.value == "<<":
            self._note(path, _place(event), "merge keys ('<<') are not allowed; write the keys out")
        elif event.tag is not None:
            self._note(path, _place(event), "a key has a tag; write the key without it")
        elif event.implicit[0] and not means_itself(event.value):
            what = f"'{shown(event.value)}' is not a word" if event.value else "a key is missing before ':'"
            self._note(path, _place(event), f"{what}; write keys such as 'age_months'")
        else:
            return event.value
        return None

    def _skip(self, event: Any) -> None:
        depth = 0
        while True:
            self._count(1, _place(event))
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth == 0:
                return
            if depth > MAX_DEPTH:  # PyYAML takes a time for each level that grows with their number.
                self._stop_too_deep(_place(event))
            event = self.events.get_event()

    def _stop_too_deep(self, place: Place) -> NoReturn:
        self.stop((), place, f"sections are nested more than {MAX_DEPTH} deep; a spec needs at most five levels")

    def _count(self, values: int, place: Place) -> None:
        self.size += values
        if self.size > MAX_VALUES:
            self.stop((), place, f"more than {MAX_VALUES} values, counting aliases; a spec has at most some 300")


def _syntax_problem(error: yaml.MarkedYAMLError, file: str) -> Problem:
    """Return an error of PyYAML's scanner or parser as a problem."""
    said = error.problem or ""
    unclosed = said.startswith(("expected ',' or", "found unexpected end of stream"))
    mark = error.context_mark if unclosed and error.context_mark else error.problem_mark
    place = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    return Problem(file, *place, "", next((text for part, text in _SYNTAX.items() if part in said), _OTHER_SYNTAX))


def _place(event: Any) -> Place:
    return (event.start_mark.line + 1, event.start_mark.column + 1)


MAX_BYTES = 2**20

_BINARY = "this is not a text file; a spec is YAML text"


@dataclass(frozen=True)
class FileKind:
    """The expected kind of file, for error messages."""

    name: str
    needs: str  # Its required keys.
    line: str  # An example of a line.


SPEC = FileKind("spec", "mimoc, name and age_months", "mimoc: 1")


@dataclass(frozen=True, repr=False)
class Source:
    """The contents of a YAML file: its data, and the line and column of each value."""

    file: str  # Name of the file in messages.
    text: str  # The unchanged text: `text.encode()` gives the bytes of the file.
    data: dict[str, Any]
    problems: tuple[Problem, ...]
    """Problems found while parsing, such as a repeated key or a NaN; they must be reported together with others."""
    invalid: frozenset[KeyPath]  # Paths at which the data differs from the file because of those problems.
    key_places: Mapping[KeyPath, Place]
    value_places: Mapping[KeyPath, Place]
    folder: Path  # Relative paths in it are relative to this folder.
    has_lines: bool = True  # Whether there is a file with lines; problems of data from Python name keys only.
    inside: KeyPath = ()  # Path of the section of a larger file that this is, which messages name.

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
