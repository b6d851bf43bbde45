"""Plots as values: what is drawn over what, which `drawing` prints for pages and `file` for pictures."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.quantities.quantity import Quantity

Ticks = Sequence[tuple[float, str]]
"""Values, and what is written beside them."""
Range = tuple[float, float]
Numbers = Sequence[float] | npt.NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True)
class Line:
    """A line through points, shape (n,) each."""

    x: Numbers
    y: Numbers
    label: str = ""
    """Label in the legend; what has the same label and no look of its own has the same colour."""
    look: str = "line"
    """Class of the style sheet of pages, and key of `file.LOOKS`."""


@dataclass(frozen=True, slots=True)
class Band:
    """The area between two curves, shape (n,) each."""

    x: Numbers
    low: Numbers
    high: Numbers
    label: str = ""
    look: str = "spread"


@dataclass(frozen=True, slots=True)
class Dots:
    """Points, shape (n,) each."""

    x: Numbers
    y: Numbers
    label: str = ""
    look: str = "dot"
    titles: tuple[str, ...] = ()
    """What a page says of each while a pointer rests on it."""
    radius: float = 2.6
    """On a page."""


@dataclass(frozen=True, slots=True)
class Plot:
    """Lines, bands and dots over two axes, whose labels and units are those of quantities."""

    x: Quantity
    y: Quantity
    lines: tuple[Line, ...] = ()
    bands: tuple[Band, ...] = ()
    dots: tuple[Dots, ...] = ()
    title: str = ""
    """What stands above it; on a page, by default, what is drawn upwards."""
    about: str = ""
    """What it shows, for those who cannot see it."""
    x_range: Range | None = None
    """Ends of the axis; None is the range of the data with some room around it."""
    y_range: Range | None = None
    x_ticks: Ticks | None = None
    """None is round numbers."""
    y_ticks: Ticks | None = None
    notes: tuple[tuple[float, float, str], ...] = ()
    """Texts beside points, on a page."""
    level: float | None = None
    """Value marked by a horizontal line."""
    level_label: str = ""
    ring: float | None = None
    """Radius of a circle marked around the origin."""
    equal: bool = False
    """Whether both axes have the same scale."""
    logarithmic: bool = False
    """Whether the horizontal axis is logarithmic."""

    @property
    def labels(self) -> list[str]:
        """Labels of the legend, each once."""
        parts: Iterable[Any] = (*self.lines, *self.dots, *self.bands)
        return [*dict.fromkeys(label for label in (*(part.label for part in parts), self.level_label) if label)]

    def to_data(self) -> dict[str, Any]:
        """Return its axes, lines and bands as plain data and arrays, for a program that draws them."""

        def arrays(part: Line | Band, *names: str) -> dict[str, Any]:
            return {"look": part.look, **{name: np.asarray(getattr(part, name)) for name in names}}

        return {
            **{axis: {"label": item.label, "unit": item.unit} for axis, item in (("x", self.x), ("y", self.y))},
            "bands": [arrays(band, "x", "low", "high") for band in self.bands],
            "lines": [arrays(line, "x", "y") for line in self.lines],
        }


@dataclass(frozen=True, slots=True)
class Sheet:
    """Plots side by side in one picture."""

    plots: tuple[Plot, ...]
    columns: int = 0
    """Plots in a row; 0 is all."""
    panel_px: tuple[int, int] = (800, 640)
    """Width and height of a plot with its axes."""
    caption: str = ""
    shared_legend: bool = False
    """Whether one legend above all plots shows every label, even where plots do not have the same labels."""
