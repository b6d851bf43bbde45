"""Figures of ages in rows: when something is reached, beside when it usually is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimoc.render.plots.curves import colours_of
from mimoc.render.plots.figure import new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH_PX, ROW_PX, FRAME_PX = 1400, 100, 260
MAX_COLUMNS = 4
"""Of the legend."""
MARKERS = "osv^DPX<>"
SPREAD = 0.55
"""Height that the marks of a row are spread over, by that of a row."""
BAR_HEIGHT = 0.7
LEGEND_PX = 90


@dataclass(frozen=True, slots=True)
class AgeRow:
    """Ages at which one thing is reached."""

    label: str
    ages_months: Mapping[str, float | None]
    """By the label of the mark; None if it is not reached."""
    usual_months: tuple[float, float] | None = None
    """When it is usually reached, drawn as a bar."""


def draw_age_rows(rows: Sequence[AgeRow], oldest_months: float, usual: str) -> "Figure":
    """Return a figure with a row of marks for each thing, the first at the top.

    Args:
        rows: The rows; all have marks of the same labels.
        oldest_months: End of the axis; what is not reached is not marked.
        usual: Label of the bars.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    figure = new_figure(WIDTH_PX, FRAME_PX + ROW_PX * len(rows))
    axes = figure.subplots()
    labels = list(rows[0].ages_months)
    bars = {place: row.usual_months for place, row in enumerate(rows) if row.usual_months}
    if bars:
        starts, ends = zip(*bars.values(), strict=True)
        widths = [end - start for start, end in zip(starts, ends, strict=True)]
        axes.barh(list(bars), widths, left=starts, height=BAR_HEIGHT, color="0.85", label=usual)
    for index, (label, colour) in enumerate(zip(labels, colours_of(len(labels)), strict=True)):
        offset = SPREAD * (index / (len(labels) - 1) - 0.5) if len(labels) > 1 else 0.0
        ages = [row.ages_months[label] for row in rows]
        marked = [(age, place + offset) for place, age in enumerate(ages) if age is not None]
        x, y = zip(*marked, strict=True) if marked else ((), ())
        marker = MARKERS[index % len(MARKERS)]
        axes.plot(x, y, linestyle="none", marker=marker, color=colour, ms=7, label=label, clip_on=False, zorder=3)
    axes.set_yticks(range(len(rows)), [row.label for row in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlim(0, oldest_months)
    axes.set_xlabel("Age [months]")
    tidy(axes)
    figure.legend(loc="upper center", ncols=MAX_COLUMNS, frameon=False)
    figure.tight_layout(rect=(0, 0, 1, 1 - LEGEND_PX / (FRAME_PX + ROW_PX * len(rows))))
    return figure
