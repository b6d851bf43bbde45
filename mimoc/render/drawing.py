"""Drawings for a page, plots among them: what an SVG shows, with every coordinate as the text that is printed."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from mimoc.base.quantity import Quantity
from mimoc.render.plots import Numbers, Plot, Range, Ticks

DECIMALS = 1  # Decimals of coordinates, in units of the drawing, which are pixels on most screens.

Point = tuple[float, float]  # Right and down, in units of the drawing.


@dataclass(frozen=True, slots=True)
class Shape:
    """A line, an area, a dot or a text."""

    tag: str
    kind: str  # Classes of the style sheet; of a text, `start`, `middle` or `end` says which end of it is at the point.
    places: tuple[tuple[str, str], ...]
    text: str = ""
    titles: tuple[str, ...] = ()  # What is said while a pointer rests on it, if anything.


@dataclass(frozen=True, slots=True)
class Drawing:
    """An SVG."""

    template: ClassVar[str] = "report/drawing.svg.j2"
    title: str  # What it shows, for those who cannot see it.
    size: Point
    shapes: Sequence[Shape]  # Those behind first.
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


def line(points: Sequence[Point], kind: str, end: str = "") -> Shape:
    """Return a line through some points."""
    return Shape("path", kind, (("d", "M" + "L".join(f"{px(x)} {px(y)}" for x, y in points) + end),))


def area(points: Sequence[Point], kind: str) -> Shape:
    """Return the area within some points."""
    return line(points, kind, "Z")


def box(x: float, y: float, width: float, height: float, kind: str) -> Shape:
    """Return an upright rectangle, from its corner at the top left."""
    return Shape("path", kind, (("d", f"M{px(x)} {px(y)}h{px(width)}v{px(height)}h{px(-width)}Z"),))


def dot(at: Point, kind: str, radius: float = 3.0, title: str = "") -> Shape:
    """Return a filled circle."""
    places = ("cx", px(at[0])), ("cy", px(at[1])), ("r", px(radius))
    return Shape("circle", kind, places, titles=(title,) if title else ())


def label(at: Point, text: str, kind: str) -> Shape:
    """Return a line of text."""
    return Shape("text", kind, (("x", px(at[0])), ("y", px(at[1]))), text)


WIDTH, HEIGHT = 340.0, 220.0
LEFT, RIGHT, TOP, BOTTOM = 42.0, 14.0, 26.0, 34.0
NOTES = 30.0  # Margin at the right where texts beside points need room.
MARGIN = 0.05  # Room beyond the data at either end, as a share of its range.
MAX_TICKS = 6
MINUS = "\u2212"


def draw_svg(plot: Plot) -> Drawing:
    """Return a plot as a drawing, with its title, a grid and the values of the ticks."""
    x = plot.x_range or _range(plot.x, plot, "x")
    y = plot.y_range or _range(plot.y, plot, "y")
    right = NOTES if plot.notes else RIGHT

    def at(across: float, up: float) -> Point:
        share = (across - x[0]) / (x[1] - x[0])
        height = (up - y[0]) / (y[1] - y[0])
        return LEFT + share * (WIDTH - LEFT - right), HEIGHT - BOTTOM - height * (HEIGHT - TOP - BOTTOM)

    def points(xs: Numbers, ys: Numbers) -> list[Point]:
        return [at(across, up) for across, up in zip(map(float, xs), map(float, ys), strict=True)]

    x_ticks = plot.x_ticks if plot.x_ticks is not None else ticks(*x)
    y_ticks = plot.y_ticks if plot.y_ticks is not None else ticks(*y)
    bands = [area([*points(band.x, band.low), *reversed(points(band.x, band.high))], band.look) for band in plot.bands]
    dots = [
        dot(point, item.look, item.radius, title)
        for item in plot.dots
        for point, title in zip(points(item.x, item.y), item.titles or ("",) * len(item.x), strict=True)
    ]
    texts = [
        label((LEFT - 34, 14), plot.title or plot.y.title, "title start"),
        label((at(sum(x) / 2, 0)[0], HEIGHT - 4), plot.x.heading, "small middle"),
        *(label((at(x[0], 0)[0] - 6, at(0, value)[1] + 4), text, "small end") for value, text in y_ticks),
        *(label((at(value, 0)[0], HEIGHT - BOTTOM + 15), text, "small middle") for value, text in x_ticks),
        *(label((at(*note[:2])[0] + 5, at(*note[:2])[1] + 4), note[2], "small start") for note in plot.notes),
    ]
    grid = [line([at(x[0], value), at(x[1], value)], "grid") for value, _ in y_ticks]
    lines = [line(points(item.x, item.y), item.look) for item in plot.lines]
    axis = line([at(x[0], y[0]), at(x[1], y[0])], "axis")
    about = plot.about or plot.title or plot.y.title
    return Drawing(about, (WIDTH, HEIGHT), (*grid, *bands, *lines, axis, *dots, *texts))


def around(values: Iterable[float], floor: float | None = None) -> Range:
    """Return the range of an axis with some room around finite values; it begins at the floor if none is below that."""
    finite = [value for value in values if math.isfinite(value)]
    low, high = (min(finite), max(finite)) if finite else (0.0, 1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-9):
        room = abs(high) / 10 or 1.0
        low, high = low - room, high + room
    room = MARGIN * (high - low)
    if floor is not None and min(finite, default=floor) >= floor:
        return floor, high + MARGIN * (high - floor)
    return low - room, high + room


def ticks(low: float, high: float, most: int = MAX_TICKS) -> Ticks:
    """Return multiples of 1, 2 or 5 times a power of ten in a range, with as few digits as tell them apart."""
    least = (high - low) / most
    power = 10.0 ** math.floor(math.log10(least))
    step = next((factor * power for factor in (1, 2, 5) if factor * power >= least * (1 - 1e-9)), 10 * power)
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [
        (number * step, f"{number * step + 0.0:,.{decimals}f}".replace("-", MINUS)) for number in range(first, last + 1)
    ]


def _range(quantity: Quantity, plot: Plot, axis: str) -> Range:
    """Return the limits of a quantity, or as far as it has none, the range of what is drawn of it."""
    low, high = quantity.limits
    if low is not None and high is not None:
        return low, high
    return around((float(value) for part in (*plot.lines, *plot.dots) for value in getattr(part, axis)), low)
