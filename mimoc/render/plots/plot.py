"""Plots as values: what is drawn over what, which `drawing` prints for pages and `file` for pictures."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.quantities.child import AGE
from mimoc.base.quantities.outcome import LEARNING, SO_FAR, TRAINED
from mimoc.base.quantities.quantity import Quantity

Ticks = Sequence[tuple[float, str]]  # Values, and what is written beside them.
Range = tuple[float, float]
Numbers = Sequence[float] | npt.NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True)
class Line:
    """A line through points, shape (n,) each."""

    x: Numbers
    y: Numbers
    label: str = ""  # Label in the legend; what has the same label and no look of its own has the same colour.
    look: str = "line"  # Class of the style sheet of pages, and key of `file.LOOKS`.


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
    titles: tuple[str, ...] = ()  # What a page says of each while a pointer rests on it.
    radius: float = 2.6  # On a page.


@dataclass(frozen=True, slots=True)
class Plot:
    """Lines, bands and dots over two axes, whose labels and units are those of quantities."""

    x: Quantity
    y: Quantity
    lines: tuple[Line, ...] = ()
    bands: tuple[Band, ...] = ()
    dots: tuple[Dots, ...] = ()
    title: str = ""  # What stands above it; on a page, by default, what is drawn upwards.
    about: str = ""  # What it shows, for those who cannot see it.
    x_range: Range | None = None  # Ends of the axis; None is the range of the data with some room around it.
    y_range: Range | None = None
    x_ticks: Ticks | None = None  # None is round numbers.
    y_ticks: Ticks | None = None
    notes: tuple[tuple[float, float, str], ...] = ()  # Texts beside points, on a page.
    level: float | None = None  # Value marked by a horizontal line.
    level_label: str = ""
    ring: float | None = None  # Radius of a circle marked around the origin.
    equal: bool = False  # Whether both axes have the same scale.
    logarithmic: bool = False  # Whether the horizontal axis is logarithmic.

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
    columns: int = 0  # Plots in a row; 0 is all.
    panel_px: tuple[int, int] = (800, 640)  # Width and height of a plot with its axes.
    caption: str = ""
    shared_legend: bool = False
    """Whether one legend above all plots shows every label, even where plots do not have the same labels."""


PANEL_PX, COLUMNS = (380, 290), 5
MARGIN = 0.1  # Room above and below values, by their range.
LEAST_WIDTH_MONTHS = 0.6  # Width that the window of a single age is drawn with.

Span = tuple[float, float, float | None, float | None]
"""Youngest and oldest age in months, and least and greatest value; None for no end."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A measure by age."""

    measure: Quantity
    points: Sequence[tuple[float, float]]  # Pairs of age in months and value.
    windows: Sequence[Span]


def windows_sheet(panels: Sequence[Panel], usual: str) -> Sheet:
    """Return a plot for each measure, with bands of *usual* values; one without an end goes to that of the axis."""
    return Sheet(tuple(_plot(panel, usual) for panel in panels), COLUMNS, PANEL_PX, shared_legend=True)


def _plot(panel: Panel, usual: str) -> Plot:
    ends = [end for _, _, low, high in panel.windows for end in (low, high) if end is not None]
    open_ended = any(None in span for span in panel.windows)
    shown = [*(value for _, value in panel.points), *ends, *[0.0] * open_ended] or [0.0, 1.0]
    least, most = min(shown), max(shown)
    room = MARGIN * (most - least or 1.0)
    y_range = (least - room, most + room)
    ages = [age for age, _ in panel.points] + [age for span in panel.windows for age in span[:2]]
    return Plot(
        x=AGE,
        y=panel.measure,
        bands=tuple(_band(span, y_range, usual) for span in panel.windows),
        dots=(Dots([age for age, _ in panel.points], [value for _, value in panel.points], "mimoc", "row"),),
        x_range=(min(ages, default=0.0) - 1.0, max(ages, default=24.0) + 1.0),
        y_range=y_range,
    )


def _band(span: Span, y_range: tuple[float, float], usual: str) -> Band:
    youngest, oldest, low, high = span
    widening = max(0.0, LEAST_WIDTH_MONTHS - (oldest - youngest)) / 2
    bottom, top = (y_range[0] if low is None else low), (y_range[1] if high is None else high)
    return Band((youngest - widening, oldest + widening), (bottom,) * 2, (top,) * 2, usual, "window")


Columns = Mapping[str, Sequence[float] | np.ndarray]
"""Columns of a learning curve by name, all of the same length, including `steps`."""


def learning_sheet(
    curves: Mapping[str, Sequence[Columns]], levels: Mapping[str, float] | None = None, level: str = "random policy"
) -> Sheet:
    """Return plots of learning curves, one for each quantity, with *levels* to compare with, by column.

    Of the seeds of a label, the line is their mean, the band their range. A single curve is drawn with what there is so
    far of episodes that have not ended.
    """
    drawn = [columns for seeds in curves.values() for columns in seeds]
    last = max((max(columns["steps"], default=1) for columns in drawn), default=1)
    plots = []
    for quantity in LEARNING:
        lines, bands = [], []
        for label, seeds in curves.items():
            rows = min((len(columns["steps"]) for columns in seeds), default=0)
            if rows == 0:
                continue
            values = np.array([np.asarray(columns[quantity.curve], float)[:rows] for columns in seeds])
            known = np.isfinite(values).any(axis=0)
            steps, values = np.asarray(seeds[0]["steps"], float)[:rows][known], values[:, known]
            lines.append(Line(steps, np.nanmean(values, axis=0), label, "marked" if len(steps) == 1 else "line"))
            if len(seeds) > 1:
                bands.append(Band(steps, np.nanmin(values, axis=0), np.nanmax(values, axis=0), label))
        if len(drawn) == 1 and quantity in SO_FAR:
            so_far = np.asarray(drawn[0].get(SO_FAR[quantity].curve, ()), float)
            if np.isfinite(so_far).any():
                lines.append(Line(drawn[0]["steps"], so_far, "so far, of unfinished episodes", "so-far"))
        plot = Plot(TRAINED, quantity, tuple(lines), tuple(bands), x_range=(0, 1.02 * last))
        if levels and quantity.curve in levels:
            plot = replace(plot, level=levels[quantity.curve], level_label=level)
        plots.append(plot)
    return Sheet(tuple(plots), columns=2, panel_px=(800, 520), shared_legend=True)
