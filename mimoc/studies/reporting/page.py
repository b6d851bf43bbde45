"""What a page shows: sections of paragraphs, tables and drawings, all as the texts that are printed."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from mimoc.compiler.mjcf.printing import TEMPLATES
from mimoc.render.drawing import Drawing
from mimoc.version import __version__

_HTML = Environment(
    loader=FileSystemLoader(TEMPLATES),
    undefined=StrictUndefined,
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


@dataclass(frozen=True, slots=True)
class Link:
    """A reference to a place on the same page."""

    target: str  # Its fragment, without `#`.
    text: str


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of a table."""

    text: str
    kind: str = "text"  # Class of the style sheet: `text`, `number`, `good`, `bad` or `code`.
    links: tuple[Link, ...] = ()  # References that follow the text.
    drawings: tuple[Drawing, ...] = ()  # Drawings that stand in the cell.
    anchors: tuple[str, ...] = ()  # Fragments by which the cell can be referred to.


@dataclass(frozen=True, slots=True)
class TextBlock:
    """A paragraph."""

    template: ClassVar[str] = "report/text.html.j2"
    text: str
    kind: str = "plain"  # Class of the style sheet: `plain`, `note` or `warning`.


@dataclass(frozen=True, slots=True)
class Code:
    """Text as it is in a file."""

    template: ClassVar[str] = "report/code.html.j2"
    text: str


@dataclass(frozen=True, slots=True)
class Table:
    """A table; numbers stand at the right of their column."""

    template: ClassVar[str] = "report/table.html.j2"
    headings: tuple[Cell, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True, slots=True)
class Tile:
    """A number that matters, and what it means."""

    name: str
    value: str
    words: str
    links: tuple[Link, ...] = ()


@dataclass(frozen=True, slots=True)
class Tiles:
    """Some numbers that matter, side by side."""

    template: ClassVar[str] = "report/tiles.html.j2"
    tiles: tuple[Tile, ...]


@dataclass(frozen=True, slots=True)
class Drawings:
    """Drawings side by side, as many in a row as there is room for."""

    template: ClassVar[str] = "report/drawings.html.j2"
    drawings: tuple[Drawing, ...]
    caption: str
    kind: str = "grid"
    """Class of the style sheet: `grid`, `pair` for larger ones, `wide` for one alone, `row` for small ones."""


@dataclass(frozen=True, slots=True)
class Details:
    """Something that is shown when it is asked for."""

    template: ClassVar[str] = "report/details.html.j2"
    summary: str
    blocks: "tuple[Block, ...]"


Block: TypeAlias = TextBlock | Code | Table | Tiles | Drawings | Details


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a page with a heading."""

    name: str  # Its fragment.
    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that is part of the page."""

    data: str  # Its URL, which holds all of it.
    about: str
    width: str
    height: str


@dataclass(frozen=True, slots=True)
class Page:
    """A page."""

    kind: str  # What it is about, in a few words, above its title.
    title: str
    lead: tuple[str, ...]  # Paragraphs below the title.
    sections: tuple[Section, ...]
    pictures: tuple[Picture, ...] = ()  # Beside the title.
    made_by: str = f"Made by mimoc {__version__}."  # The last line.


def table(headings: Sequence[str], rows: Iterable[Sequence[Cell]]) -> Table:
    """Return a table; a heading stands as its column does."""
    cells = tuple(map(tuple, rows))
    kinds = [cell.kind if cell.kind == "number" else "text" for cell in cells[0]] if cells else ["text"] * len(headings)
    return Table(tuple(Cell(text, kind) for text, kind in zip(headings, kinds, strict=True)), cells)


def number(text: str, *links: Link) -> Cell:
    """Return a cell with a number."""
    return Cell(text, "number", links)


def render(page: Page) -> bytes:
    """Return a page as HTML, all that it shows included; the same page gives the same bytes."""
    return _HTML.get_template("report/page.html.j2").render(page=page).encode()
