"""Whether MJCF is what mimoc writes, before MuJoCo reads any of it."""

import re
from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NoReturn
from xml.parsers import expat

from mimoc.bundle.mjcf_rules import ELEMENTS, MOST, MOST_BYTES, MOST_DEPTH, MOST_ELEMENTS, REFERRING, Values
from mimoc.errors import BundleError

_BEYOND_ELEMENTS = re.compile(rb"<[!?]|&#|>\s*+[^<\s]")
"""Where comments, declarations, numbered characters and text between elements begin: mimoc writes none, and parsers
differ in them."""
_SHOWN = 60


@dataclass(frozen=True, slots=True)
class Mjcf:
    """What is in a file of MJCF that mimoc could have written."""

    counts: Counter[str]
    """How many there are of each element."""
    references: dict[str, str]
    """The element that refers to each other file, by the path of that."""


def read_mjcf(file: str, content: bytes) -> Mjcf:
    """Return what is in a file of MJCF.

    Args:
        file: Its name, for errors.
        content: The file.

    Raises:
        BundleError: If mimoc writes no such thing; the message says where it is.
    """
    if len(content) > MOST_BYTES:
        raise BundleError(f"{file}: it has more than {MOST_BYTES >> 20} MB, which no infant needs")
    if beyond := _BEYOND_ELEMENTS.search(content):
        raise BundleError(f"{file}:{_line(content, beyond.start())}: mimoc writes nothing but elements")
    reader = _Reader(file)
    reader.read(content)
    if not all(values.allow(given) for values, given in reader.given.items()):
        _Reader(file, at_once=True).read(content)
    _check_amounts(file, reader.counts)
    return Mjcf(reader.counts, reader.references)


class _Reader:
    """Reads MJCF element by element, and refuses what mimoc does not write."""

    def __init__(self, file: str, *, at_once: bool = False):
        """Begin a file.

        Args:
            file: Its name.
            at_once: Whether to check each value where it is; it takes less time to check them together in the end.
        """
        self.counts, self.references = Counter[str](), dict[str, str]()
        self.given: defaultdict[Values, list[str]] = defaultdict(list)
        """The values of all attributes, by what they may be."""
        self._sinks: dict[str, dict[str, Callable[[str], None]]] = {}
        """What takes the values of each attribute, by element."""
        self._file, self._at_once, self._depth, self._muscles = file, at_once, 0, False
        self._parser: Any = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler, self._parser.EndElementHandler = self._begin, self._end

    def read(self, content: bytes) -> None:
        """Read the whole file."""
        try:
            self._parser.Parse(content, True)
        except (expat.ExpatError, UnicodeDecodeError) as error:
            raise BundleError(f"{self._file}: it is not XML ({error})") from None

    def _begin(self, element: str, attributes: dict[str, str]) -> None:
        sinks = self._sinks.get(element) or self._sinks_of(element)
        self.counts[element] += 1
        self._depth += 1
        if self._depth > MOST_DEPTH:
            self._refuse(f"more than {MOST_DEPTH} elements within each other")
        for name, value in attributes.items():
            if name not in sinks:
                self._refuse(f"{name[:_SHOWN]!r} is not an attribute that mimoc gives <{element}>")
            sinks[name](value)
        if self._at_once:
            self._check(element, attributes)
        if element in REFERRING and "file" in attributes:
            self.references[attributes["file"]] = element
        elif element == "general":
            self._check_muscle(attributes)

    def _sinks_of(self, element: str) -> dict[str, Callable[[str], None]]:
        if element not in ELEMENTS:
            self._refuse(f"<{element[:_SHOWN]}> is not an element that mimoc writes")
        self._sinks[element] = {name: self.given[values].append for name, values in ELEMENTS[element].items()}
        return self._sinks[element]

    def _check(self, element: str, attributes: dict[str, str]) -> None:
        for name, value in attributes.items():
            if not ELEMENTS[element][name].allow([value]):
                self._refuse(f"{name}={value[:_SHOWN]!r} is not what mimoc writes there")

    def _check_muscle(self, attributes: dict[str, str]) -> None:
        """MuJoCo finds the lengths of a muscle that does not give them by simulating it, which takes long."""
        self._muscles |= "muscle" in (attributes.get("gaintype"), attributes.get("biastype"))
        if self._muscles and "joint" in attributes:
            lengths = attributes.get("lengthrange", "").split()
            if len(lengths) != 2 or not _is_rising(lengths):
                self._refuse("a muscle without a lengthrange")

    def _end(self, element: str) -> None:
        self._depth -= 1

    def _refuse(self, reason: str) -> NoReturn:
        raise BundleError(f"{self._file}:{self._parser.CurrentLineNumber}: {reason}")


def _check_amounts(file: str, counts: Counter[str]) -> None:
    many = [name for name, most in MOST.items() if counts[name] > most]
    if many:
        raise BundleError(f"{file}: {counts[many[0]]:,} times <{many[0]}>, where at most {MOST[many[0]]:,} may be")
    if counts.total() > MOST_ELEMENTS:
        raise BundleError(f"{file}: {counts.total():,} elements, where at most {MOST_ELEMENTS:,} may be")


def _is_rising(numbers: list[str]) -> bool:
    try:
        return float(numbers[0]) < float(numbers[1])
    except ValueError:
        return False


def _line(content: bytes, place: int) -> int:
    return content.count(b"\n", 0, place) + 1
