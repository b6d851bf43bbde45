"""Reading of a scene in MJCF: its elements with the files that it includes, and the files that it refers to."""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

from mimoc.base.errors import Problem, SpecError
from mimoc.bundle.mjcf_check import MOST_BYTES, MOST_DEPTH, MOST_ELEMENTS
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file

MOST_INCLUDES = 64
COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)
"""Removed before parsing: MuJoCo reads comments with two hyphens in them, which are not XML."""
INDENT = "  "


@dataclass(slots=True, eq=False)
class Element:
    """An element of MJCF, and where it was read."""

    tag: str
    attributes: dict[str, str]
    file: str = ""
    line: int = 0
    children: "list[Element]" = field(default_factory=list["Element"])

    def get(self, name: str) -> str:
        """Return the value of an attribute, empty if it is not given."""
        return self.attributes.get(name, "")

    def walk(self) -> "Iterator[Element]":
        """Yield this element and all below it."""
        yield self
        for child in self.children:
            yield from child.walk()

    def problem(self, message: str) -> Problem:
        """Return a problem with this element, or a note on it."""
        name = self.get("name")
        return Problem(self.file, self.line, 1, f"{self.tag} '{name}'" if name else self.tag, message)

    def lines(self) -> "Iterator[Element]":
        """Yield the element that begins or ends in each line of its text."""
        yield self
        for child in self.children:
            yield from child.lines()
        if self.children:
            yield self

    def xml(self, indent: str = "") -> str:
        """Return the element as text, one element a line."""
        start = "".join([f"{indent}<{self.tag}", *(f" {name}={quoteattr(it)}" for name, it in self.attributes.items())])
        if not self.children:
            return f"{start}/>\n"
        inside = "".join(child.xml(indent + INDENT) for child in self.children)
        return f"{start}>\n{inside}{indent}</{self.tag}>\n"


def read_scene(path: Path) -> Element:
    """Return the root element of a scene, with its includes replaced by what they include.

    Like MuJoCo, it looks for what is included in the folder of the scene, then in that of the file that includes it,
    and includes each file once.

    Raises:
        SpecError: If a file is missing or is not MJCF; the error lists all problems of that kind.
    """
    reader = _Reader(path)
    root = reader.read(path.resolve() if path.is_symlink() else path, str(path), Problem(str(path), 1, 1, "", ""))
    if root is None or reader.problems:
        raise SpecError(reader.problems)
    return root


def read_file(path: Path, most_bytes: int) -> bytes:
    """Return the content of a file that a scene refers to, or raise an UnusableFileError that says what is wrong."""
    try:
        content = read_regular_file(path, most_bytes)
    except UnusableFileError as error:
        reason = str(error).replace("a link, which mimoc never writes", "a link, which mimoc does not follow")
        raise UnusableFileError(f"{reason}; put the file itself in its place") from None
    except ValueError:  # A path with a NUL in it.
        content = None
    if content is None:
        raise UnusableFileError("does not exist or cannot be read; check the path")
    return content


def first_existing(path: Path, other: Path) -> Path:
    """Return the path of two at which there is something, the first if both or none."""
    return other if os.path.lexists(other) and not os.path.lexists(path) else path


class _Reader:
    """Reads one scene and the files that it includes."""

    def __init__(self, main: Path):
        self.problems: list[Problem] = []
        self._folder, self._included, self._elements = main.parent, set[Path](), 0

    def read(self, path: Path, shown: str, place: Problem) -> Element | None:
        """Return the root element of a file; None if there is a problem with it."""
        self._included.add(path.resolve())
        try:
            content = read_file(path, MOST_BYTES)
        except UnusableFileError as error:
            what = f"'{shown}' {error}" if place.key else f"this {error}"
            self.problems.append(Problem(place.file, place.line, place.column, place.key, what))
            return None
        if b"\0" in content:
            return self._refuse(shown, 1, "this is a binary file; give the MJCF (XML) of a scene")
        root = self._parse(content, shown)
        if root and not place.key and root.tag != "mujoco":
            return self._refuse(shown, root.line, f"this is not MJCF: it begins with <{root.tag}>, not with <mujoco>")
        if root:
            self._include(root)
        return root

    def _parse(self, content: bytes, shown: str) -> Element | None:
        plain = COMMENT.sub(lambda comment: b"\n" * comment[0].count(b"\n"), content)
        parser: Any = expat.ParserCreate()
        holder = Element("", {})
        opened = [holder]

        def begin(tag: str, attributes: dict[str, str]) -> None:
            self._elements += 1
            if len(opened) > MOST_DEPTH or self._elements > MOST_ELEMENTS:
                raise ValueError(f"more than {MOST_ELEMENTS:,} elements, or {MOST_DEPTH} within each other")
            element = Element(tag, attributes, shown, parser.CurrentLineNumber)
            opened[-1].children.append(element)
            opened.append(element)

        def declare(*_: Any) -> None:
            raise ValueError("it declares a document type, which MJCF does not have; remove it")

        parser.StartElementHandler, parser.StartDoctypeDeclHandler = begin, declare
        parser.EndElementHandler = lambda tag: opened.pop()
        try:
            parser.Parse(plain, True)
        except expat.ExpatError as error:
            return self._refuse(shown, error.lineno, f"this is not XML ({expat.ErrorString(error.code)}); correct it")
        except (ValueError, LookupError) as error:  # LookupError: an encoding that nobody knows.
            return self._refuse(shown, parser.CurrentLineNumber, f"this cannot be read: {error}")
        return holder.children[0]

    def _include(self, element: Element) -> None:
        children: list[Element] = []
        for child in element.children:
            if child.tag != "include":
                self._include(child)
                children.append(child)
            elif included := self._included_by(child):
                children += included.children
        element.children = children

    def _included_by(self, element: Element) -> Element | None:
        name = element.get("file")
        path = first_existing(self._folder / name, Path(element.file).parent / name)
        if not name or path.resolve() in self._included:
            what = "is included a second time, which MuJoCo does not allow; remove this" if name else "names no file"
            self.problems.append(element.problem(f"'{name}' {what}"))
            return None
        if len(self._included) > MOST_INCLUDES:
            self.problems.append(element.problem(f"more than {MOST_INCLUDES} files are included"))
            return None
        return self.read(path, str(path), element.problem(""))

    def _refuse(self, shown: str, line: int, message: str) -> None:
        self.problems.append(Problem(shown, line, 1, "", message))
