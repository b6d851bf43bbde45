"""Drawings for a page: what an SVG shows, with every coordinate as the text that is printed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

DECIMALS = 1
"""Of coordinates, in units of the drawing, which are pixels on most screens."""

Point = tuple[float, float]
"""Right and down, in units of the drawing."""


@dataclass(frozen=True, slots=True)
class Path:
    """A line or an area."""

    d: str
    kind: str
    """Class of the style sheet, such as `line` or `band`."""
    titles: tuple[str, ...] = ()
    """What is said while a pointer rests on it, if anything."""


@dataclass(frozen=True, slots=True)
class Dot:
    """A filled circle."""

    x: str
    y: str
    radius: str
    kind: str
    titles: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Label:
    """A line of text."""

    x: str
    y: str
    text: str
    kind: str
    """Classes of the style sheet; `start`, `middle` or `end` says which end of the text is at the point."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """An SVG: paths first, then dots, then labels."""

    template: ClassVar[str] = "report/drawing.svg.j2"
    title: str
    """What it shows, for those who cannot see it."""
    size: Point
    """Width and height."""
    paths: Sequence[Path] = ()
    dots: Sequence[Dot] = ()
    labels: Sequence[Label] = ()
    kind: str = "plot"

    @property
    def width(self) -> str:
        """Width as it is printed."""
        return px(self.size[0])

    @property
    def height(self) -> str:
        """Height as it is printed."""
        return px(self.size[1])


def px(value: float) -> str:
    """Return a coordinate as it is printed: the one place where those of drawings are rounded."""
    return f"{round(float(value), DECIMALS) + 0.0:g}"


def line(points: Sequence[Point], kind: str, title: str = "") -> Path:
    """Return a line through some points."""
    return Path(_through(points), kind, _titles(title))


def area(points: Sequence[Point], kind: str, title: str = "") -> Path:
    """Return the area within some points."""
    return Path(f"{_through(points)}Z", kind, _titles(title))


def box(x: float, y: float, width: float, height: float, kind: str, title: str = "") -> Path:
    """Return an upright rectangle, from its corner at the top left."""
    return Path(f"M{px(x)} {px(y)}h{px(width)}v{px(height)}h{px(-width)}Z", kind, _titles(title))


def dot(at: Point, kind: str, radius: float = 3.0, title: str = "") -> Dot:
    """Return a dot."""
    return Dot(px(at[0]), px(at[1]), px(radius), kind, _titles(title))


def label(at: Point, text: str, kind: str) -> Label:
    """Return a line of text."""
    return Label(px(at[0]), px(at[1]), text, kind)


def _titles(title: str) -> tuple[str, ...]:
    return (title,) if title else ()


def _through(points: Sequence[Point]) -> str:
    return "M" + "L".join(f"{px(x)} {px(y)}" for x, y in points)
