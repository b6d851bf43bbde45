"""Plots of an infant's measurements over the means of AnthroKids."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mimoc.bundle.files import write_file
from mimoc.fits import load_tables, measure
from mimoc.render.plots.figure import encode, new_figure, tidy
from mimoc.render.plots.growth import INFANT_COLOUR, LAST_MONTH, SURVEY_COLOUR, check_plot_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = 6
PANEL_PX = (330, 270)
MARGIN_PX = 120

CAPTION = (
    "mimoc: measured on the compiled models as on children.  AnthroKids: means of age groups, at the middle of their "
    "months (Snyder et al. 1977), with a band of 4 %.  Curve: growth law of the average child."
)

Points = Sequence[tuple[float, float]]
"""Pairs of age in months and value in cm."""


def plot_measurements(series: Mapping[str, Points], tolerance: float, path: str | Path) -> None:
    """Write a plot of an infant's measurements over the survey's, in the format of its name.

    Args:
        series: Measured values by AnthroKids name.
        tolerance: Half width of the band around the means, relative to them.
        path: File to write.

    Raises:
        OutputError: If the file cannot be written there.
        MissingExtraError: If matplotlib is not installed.
    """
    check_plot_name(path)
    write_file(path, encode(draw_measurements(series, tolerance), Path(path).suffix.lower()))


def draw_measurements(series: Mapping[str, Points], tolerance: float) -> "Figure":
    """Return the figure, with one panel for each measurement; arguments are those of `plot_measurements`.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    rows = math.ceil(len(series) / COLUMNS)
    width_px, height_px = COLUMNS * PANEL_PX[0], rows * PANEL_PX[1] + MARGIN_PX
    figure = new_figure(width_px, height_px)
    panels = figure.subplots(rows, COLUMNS, squeeze=False).flat
    for axes, (name, points) in zip(panels, sorted(series.items()), strict=False):
        _draw_panel(axes, name, points, tolerance)
    for axes in list(panels)[len(series) :]:
        axes.set_axis_off()
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=len(labels), frameon=False)
    figure.text(0.5, 0.008, CAPTION, ha="center", va="bottom", fontsize=7.5, color="0.35")
    half = MARGIN_PX / 2 / height_px
    figure.tight_layout(rect=(0, half, 1, 1 - half))
    return figure


def _draw_panel(axes: "Axes", name: str, points: Points, tolerance: float) -> None:
    means = load_tables().anthrokids.get(name, ())
    surveyed = [point for point in measure(0).table[name].points if point.age_months <= LAST_MONTH][-len(means) :]
    if means:
        axes.errorbar(
            [point.age_months for point in surveyed],
            [point.value_cm for point in surveyed],
            [tolerance * point.value_cm for point in surveyed],
            fmt="x",
            color=SURVEY_COLOUR,
            label="AnthroKids",
        )
    ages_months = [quarter / 4 for quarter in range(4 * LAST_MONTH + 1)]
    axes.plot(ages_months, [100 * measure(age)[name] for age in ages_months], color="0.75", label="curve", zorder=1)
    ages, values = zip(*points, strict=True)
    axes.plot(ages, values, "o-", color=INFANT_COLOUR, markersize=3.5, linewidth=1.2, label="mimoc", zorder=3)
    axes.set_title(f"{name.replace('_', ' ')} [cm]", loc="left", fontsize=7.5)
    axes.tick_params(labelsize=7)
    axes.set_xlim(-0.5, LAST_MONTH + 0.5)
    axes.set_xticks(range(0, LAST_MONTH + 1, 6))
    tidy(axes)
