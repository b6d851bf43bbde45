"""Windows of motor milestones as horizontal bars, as in WHO's chart, with an infant's own ages."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mimoc.bundle.files import write_file
from mimoc.render.plots.figure import encode, new_figure, tidy
from mimoc.render.plots.growth import INFANT_COLOUR, LAST_MONTH, WHO_COLOUR, check_plot_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH_PX, BAR_PX, FRAME_PX = 1600, 80, 240


@dataclass(frozen=True, slots=True)
class Bar:
    """One milestone."""

    label: str
    window_months: tuple[float, float, float] | None
    """Youngest, median and oldest age of real infants; None if unknown."""
    infant_months: float | None
    """The infant's own age; None if it does not reach the milestone."""


def plot_milestones(bars: Sequence[Bar], path: str | Path) -> None:
    """Write a plot of milestones, in the format of the file's name.

    Raises:
        OutputError: If the file cannot be written there.
        MissingExtraError: If matplotlib is not installed.
    """
    check_plot_name(path)
    write_file(path, encode(draw_milestones(bars), Path(path).suffix.lower()))


def draw_milestones(bars: Sequence[Bar]) -> "Figure":
    """Return the figure, the first milestone at the bottom.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    figure = new_figure(WIDTH_PX, FRAME_PX + BAR_PX * len(bars))
    axes = figure.subplots()
    for row, bar in enumerate(bars):
        if bar.window_months:
            youngest, median, oldest = bar.window_months
            axes.barh(row, oldest - youngest, left=youngest, height=0.5, color=WHO_COLOUR, alpha=0.35)
            axes.plot([median, median], [row - 0.25, row + 0.25], color=WHO_COLOUR, linewidth=2)
        if bar.infant_months is not None:
            axes.plot(bar.infant_months, row, marker="D", ms=7, color=INFANT_COLOUR, linestyle="none")
    axes.plot([], [], marker="D", color=INFANT_COLOUR, linestyle="none", label="mimoc, from this age on")
    axes.plot([], [], color=WHO_COLOUR, linewidth=8, alpha=0.35, label="real infants (line: median)")
    axes.set_yticks(range(len(bars)), [bar.label for bar in bars])
    axes.set_xlim(-0.5, LAST_MONTH)
    axes.set_xlabel("Age [months]")
    axes.legend(loc="lower right", frameon=False)
    tidy(axes)
    figure.tight_layout()
    return figure
