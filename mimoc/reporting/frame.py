"""The frame of a plot: two axes with their ticks, and where data lies between them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mimoc.reporting.drawing import Dot, Drawing, Label, Path, Point, area, drawing, label, line
from mimoc.reporting.words import MINUS

WIDTH, HEIGHT = 340.0, 220.0
LEFT, RIGHT, TOP, BOTTOM = 42.0, 14.0, 26.0, 34.0
"""Margins around the data."""
MARGIN = 0.05
"""Room beyond the data at either end, as a share of its range."""
MOST_TICKS = 6

Ticks = Sequence[tuple[float, str]]
"""Values, and what is written beside them."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Axes from the least to the largest value; the vertical one points up."""

    x: tuple[float, float]
    y: tuple[float, float]
    width: float = WIDTH
    height: float = HEIGHT
    right: float = RIGHT

    def at(self, x: float, y: float) -> Point:
        """Return where a pair of values lies in the drawing."""
        across = (x - self.x[0]) / (self.x[1] - self.x[0])
        up = (y - self.y[0]) / (self.y[1] - self.y[0])
        return (
            LEFT + across * (self.width - LEFT - self.right),
            self.height - BOTTOM - up * (self.height - TOP - BOTTOM),
        )

    def line(self, points: Iterable[tuple[float, float]], kind: str, title: str = "") -> Path:
        """Return a line through some pairs of values."""
        return line([self.at(*point) for point in points], kind, title)

    def band(self, xs: Sequence[float], low: Sequence[float], high: Sequence[float], kind: str) -> Path:
        """Return the area between two curves."""
        there = [*zip(xs, low, strict=True)]
        back = [*zip(xs, high, strict=True)][::-1]
        return area([self.at(*point) for point in (*there, *back)], kind)

    def draw(
        self,
        title: str,
        x_label: str,
        paths: Iterable[Path] = (),
        dots: Iterable[Dot] = (),
        labels: Iterable[Label] = (),
        x_ticks: Ticks | None = None,
        description: str = "",
    ) -> Drawing:
        """Return the plot, with its title, a grid and the values of the ticks.

        Args:
            title: What stands above it, with the unit.
            x_label: What stands below it.
            paths: Lines and areas of the data.
            dots: Points of the data.
            labels: Texts beside the data.
            x_ticks: Ticks of the horizontal axis; None is round numbers.
            description: For those who cannot see it; else the title.
        """
        x_ticks = x_ticks if x_ticks is not None else ticks(*self.x)
        y_ticks = ticks(*self.y)
        grid = [self.line([(self.x[0], y), (self.x[1], y)], "grid") for y, _ in y_ticks]
        axis = self.line([(self.x[0], self.y[0]), (self.x[1], self.y[0])], "axis")
        bottom, (left, _) = self.height - BOTTOM, self.at(self.x[0], self.y[0])
        texts = [
            label((LEFT - 34, 14), title, "title start"),
            label((self.at(sum(self.x) / 2, 0)[0], self.height - 4), x_label, "small middle"),
            *(label((left - 6, self.at(0, y)[1] + 4), text, "small end") for y, text in y_ticks),
            *(label((self.at(x, 0)[0], bottom + 15), text, "small middle") for x, text in x_ticks),
        ]
        size = (self.width, self.height)
        return drawing(description or title, size, (*grid, *paths, axis), dots, (*texts, *labels))


def around(values: Iterable[float], floor: float | None = None) -> tuple[float, float]:
    """Return the range of an axis with some room around finite values.

    Args:
        values: The values; without any, the axis goes from 0 to 1.
        floor: Where the axis begins, if no value is below that.
    """
    found = [value for value in values if math.isfinite(value)]
    low, high = (min(found), max(found)) if found else (0.0, 1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-9):
        room = abs(high) / 10 or 1.0
        low, high = low - room, high + room
    room = MARGIN * (high - low)
    if floor is not None and min(found, default=floor) >= floor:
        return floor, high + MARGIN * (high - floor)
    return low - room, high + room


def ticks(low: float, high: float, most: int = MOST_TICKS) -> Ticks:
    """Return round values within a range, with as few digits as tell them apart."""
    step = _round_step((high - low) / most)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [
        (number * step, f"{number * step + 0.0:,.{decimals}f}".replace("-", MINUS)) for number in range(first, last + 1)
    ]


def _round_step(least: float) -> float:
    """Return the smallest of 1, 2 and 5 times a power of ten that is not below a number."""
    power = 10.0 ** math.floor(math.log10(least))
    return next((factor * power for factor in (1, 2, 5) if factor * power >= least * (1 - 1e-9)), 10 * power)
