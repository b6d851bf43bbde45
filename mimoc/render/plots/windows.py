"""Measures of an infant by age, over windows of values that real infants have."""

from collections.abc import Sequence
from dataclasses import dataclass

from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import AGE
from mimoc.render.plots.plot import Band, Dots, Plot, Sheet

PANEL_PX, COLUMNS = (380, 290), 5
MARGIN = 0.1
"""Room above and below values, by their range."""
LEAST_WIDTH_MONTHS = 0.6
"""Width that the window of a single age is drawn with."""

Span = tuple[float, float, float | None, float | None]
"""Youngest and oldest age in months, and least and greatest value; None for no end."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A measure by age."""

    measure: Quantity
    points: Sequence[tuple[float, float]]
    """Pairs of age in months and value."""
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
