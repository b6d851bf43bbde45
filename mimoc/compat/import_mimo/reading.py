"""Reading of a scene in MJCF: its elements, with those of the files that it includes, and the files of its assets."""

import math
import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

from mimoc.base.errors import Problem, SpecError
from mimoc.bundle import mjcf_check, regular_files
from mimoc.bundle.mjcf_check import MAX_COUNTS, MAX_DEPTH, MAX_ELEMENTS, MAX_PIXELS, pixels_of
from mimoc.bundle.regular_files import MAX_BYTES_IN_ALL, UnusableFileError, read_regular_file

MAX_INCLUDES = 64
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
        self._folder = main.parent
        self._included = set[Path]()
        self._elements = 0

    def read(self, path: Path, shown: str, place: Problem) -> Element | None:
        """Return the root element of a file; None if there is a problem with it."""
        self._included.add(path.resolve())
        try:
            content = read_file(path, mjcf_check.MAX_BYTES)
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
            if len(opened) > MAX_DEPTH or self._elements > MAX_ELEMENTS:
                raise ValueError(f"more than {MAX_ELEMENTS:,} elements, or {MAX_DEPTH} within each other")
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
        if len(self._included) > MAX_INCLUDES:
            self.problems.append(element.problem(f"more than {MAX_INCLUDES} files are included"))
            return None
        return self.read(path, str(path), element.problem(""))

    def _refuse(self, shown: str, line: int, message: str) -> None:
        self.problems.append(Problem(shown, line, 1, "", message))


MAX_MAGNITUDE = 1e10  # Largest magnitude of any number, as in the MJCF of bundles.
TIMESTEP_S = 1e-4, 1.0  # Physics steps that a spec can have (`control.timestep_ms`).
MAX_SAMPLES = 2**20  # Most samples of a height field; enough for a terrain of 10 m at every centimetre.
MAX_LENGTH_RANGE_STEPS = 1e5
"""Steps by which MuJoCo's compiler may look for the length range of a muscle; by default 1,000."""
BOUNDS: Mapping[str, float] = {
    **dict.fromkeys(("width", "height", "offwidth", "offheight", "resolution"), 4096),
    **dict.fromkeys(("shadowsize", "nrow", "ncol", "dim", "actdim", "nsample", "nuserdata"), 2**14),
    **dict.fromkeys(("njmax", "nconmax"), 1e6),
    **dict.fromkeys(("numslices", "numstacks", "numquads", "nkey"), 1000),
    **dict.fromkeys(("octree_maxdepth", "subdivision"), 8),
    "nstack": 1e8,
}
"""Largest values of attributes for which MuJoCo sets memory or time aside, besides `nuser_*` and `*iterations`."""
BYTES = {"k": 2**10, "m": 2**20, "g": 2**30}
GENERATORS = ("replicate", "composite", "flexcomp")  # Elements of which MuJoCo makes many.
ATTACHES = "attaches another model; include its parts, or write them into the scene"
REFUSED: Mapping[str, str] = {
    "plugin": "uses a plug-in of MuJoCo's, which mimoc does not load; remove it",
    "extension": "uses plug-ins of MuJoCo's, which mimoc does not load; remove it",
    "attach": ATTACHES,
}


def check_limits(scene: Element) -> None:
    """Raise a SpecError with all problems unless a scene is small enough and its numbers are sensible."""
    problems = [problem for element in scene.walk() for problem in _problems_of(element)]
    if not problems:
        counts = Counter[str]()
        _count(scene, 1, counts)
        problems = [
            scene.problem(f"has {counts[tag]:,} <{tag}>, copies included; at most {most:,} are read")
            for tag, most in MAX_COUNTS.items()
            if counts[tag] > most
        ]
        if counts.total() > MAX_ELEMENTS:
            problems.append(scene.problem(f"has {counts.total():,} elements in all; at most {MAX_ELEMENTS:,} are read"))
    if problems:
        raise SpecError(problems)


def _problems_of(element: Element) -> Iterator[Problem]:
    if element.tag in REFUSED:
        yield element.problem(REFUSED[element.tag])
    if element.tag == "flexcomp" and element.get("file"):
        yield element.problem("makes a flexible body of a file, of which bundles have none; remove it")
    numbers = {name: found for name, value in element.attributes.items() if (found := _numbers(name, value))}
    for name, values in numbers.items():
        if not all(abs(value) <= MAX_MAGNITUDE for value in values):
            yield element.problem(f"{name} is no number, or above {MAX_MAGNITUDE:g}; correct it")
        elif max(values) > (most := _bound(element, name)):
            yield element.problem(f"{name} is {max(values):,.12g}; give {most:,.12g} at most")
    if element.tag == "option" and "timestep" in numbers:
        least, most = TIMESTEP_S
        if not least <= numbers["timestep"][0] <= most:
            yield element.problem(f"timestep is {numbers['timestep'][0]:g}; give {least:g} to {most:g} s")
    if element.tag == "hfield" and math.prod(numbers.get(name, [1])[0] for name in ("nrow", "ncol")) > MAX_SAMPLES:
        yield element.problem(f"has more than {MAX_SAMPLES:,} samples; make nrow and ncol smaller")
    if element.tag == "lengthrange":
        total_s, step_s = numbers.get("inttotal", [10.0])[0], numbers.get("timestep", [0.01])[0]
        if not 0 < total_s <= MAX_LENGTH_RANGE_STEPS * step_s:
            yield element.problem("simulates too many steps, or none; leave inttotal and timestep out")
    if element.tag == "size" and _bytes(element.get("memory")) > BYTES["g"]:
        yield element.problem("memory is above 1 GB; leave it out")


def _bound(element: Element, name: str) -> float:
    if element.tag in ("spatial", "site", "geom", "camera") and name != "resolution":
        return math.inf  # A width there is one in metres.
    if name.startswith("nuser_") or name.endswith("iterations"):
        return 1000
    if element.tag in GENERATORS and name == "count":
        return MAX_ELEMENTS
    return BOUNDS.get(name, math.inf)


def _numbers(name: str, value: str) -> list[float]:
    if name in ("name", "class", "childclass", "file", "user"):
        return []
    try:
        return [float(word) for word in value.split()]
    except ValueError:
        return []


def _bytes(memory: str) -> float:
    """Return a size such as `10M` in bytes, 0 if it is none: MuJoCo says so."""
    number, factor = (memory[:-1], BYTES.get(memory[-1:].lower(), 0)) if memory[-1:].isalpha() else (memory, 1)
    try:
        return float(number) * factor
    except ValueError:
        return 0.0


def _count(element: Element, copies: float, counts: Counter[str]) -> None:
    """Count elements as MuJoCo will have them: with the copies that it makes."""
    made = max(1.0, math.prod(_numbers("count", element.get("count")))) if element.tag in GENERATORS else 1.0
    copies = min(copies * made, 1e12)  # Beyond any limit already.
    counts[element.tag] += math.ceil(copies)
    if element.tag in ("composite", "flexcomp"):
        counts["body"] += math.ceil(copies)
    for child in element.children:
        _count(child, copies, counts)


FOLDERS = ("assetdir", "meshdir", "texturedir", "strippath")
"""Attributes of `compiler` that say where files are; those of the new scene are all in one folder."""
COLOUR = {"builtin": "flat", "width": "1", "height": "1"}


def file_attributes(element: Element) -> list[str]:
    """Return the attributes of an element that name files; a cube's texture has up to six of them."""
    return [name for name in element.attributes if name.startswith("file")]


def without_pictures(tree: Element) -> Element:
    """Return a scene whose textures are plain colours: its physics, which needs none of their files."""
    attributes = tree.attributes
    children = [without_pictures(child) for child in tree.children]
    if tree.tag == "texture" and (names := file_attributes(tree)):
        attributes = {name: value for name, value in attributes.items() if name not in names} | COLOUR
    return replace(tree, attributes=attributes, children=children)


class AssetFiles:
    """Reads the files of assets, and gives each a name of its own in one folder."""

    def __init__(self, tree: Element, folder: Path):
        self._folder = folder
        self._settings = {
            name: value
            for compiler in tree.children
            if compiler.tag == "compiler"
            for name, value in compiler.attributes.items()
        }
        self._names = dict[Path, str]()
        self._left, self._pixels_left = MAX_BYTES_IN_ALL, MAX_PIXELS
        self.files: dict[str, bytes] = {}
        """Content by name."""
        self.sources: set[Path] = set()

    def moved(self, tree: Element, place: str = "") -> Element:
        """Return elements whose files are in the folder *place*, and read these; a SpecError lists all missing ones."""
        problems: list[Problem] = []
        result = self._moved(tree, place, problems)
        if problems:
            raise SpecError(problems)
        return result

    def _moved(self, element: Element, place: str, problems: list[Problem]) -> Element:
        attributes = dict(element.attributes)
        if element.tag == "compiler":
            attributes = {name: value for name, value in attributes.items() if name not in FOLDERS}
        if element.tag == "model" and element.get("file"):
            problems.append(element.problem(ATTACHES))
            return element
        for name in file_attributes(element):
            path = self._path(element, attributes[name])
            try:
                attributes[name] = place + self._name(path, element.tag in ("texture", "hfield"))
            except UnusableFileError as error:
                problems.append(element.problem(f"the file '{path}' {error}"))
        children = [self._moved(child, place, problems) for child in element.children]
        return replace(element, attributes=attributes, children=children)

    def _path(self, element: Element, name: str) -> Path:
        """Return where MuJoCo finds a file of a kind of asset: as seen from the scene, or else from what names it."""
        kind = "texturedir" if element.tag == "texture" else "meshdir"
        place = self._settings.get(kind) or self._settings.get("assetdir", "")
        strips = self._settings.get("strippath") in ("true", "1")
        name = PurePosixPath(name).name if strips else name
        beside = os.path.relpath(Path(element.file).parent, self._folder)
        return first_existing(self._folder / place / name, self._folder / place / beside / name)

    def _name(self, path: Path, is_picture: bool) -> str:
        if path not in self._names:
            content = read_file(path, min(regular_files.MAX_BYTES, self._left))
            self._left -= len(content)
            if is_picture and path.suffix.lower() == ".png":
                self._pixels_left -= pixels_of(content, is_ours=False)
                if self._pixels_left < 0:
                    raise UnusableFileError(f"and others have more than {MAX_PIXELS:,} pixels together")
            taken, number = set(self._names.values()), 1
            name = path.name
            while name in taken:
                number += 1
                name = f"{path.stem}_{number}{path.suffix}"
            self._names[path] = name
            self.files[name] = content
            self.sources.add(path.resolve())
        return self._names[path]
