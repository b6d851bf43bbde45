"""Plots of an infant's growth against WHO's standards, as in figure 2 of the paper."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from mimoc.bundle.files import write_file
from mimoc.errors import OutputError
from mimoc.fits import BIRTH, GrowthStandard, load_tables, measure
from mimoc.fits.measurements import DataPoint
from mimoc.fits.who import Reference
from mimoc.render.plots.figure import FORMATS, encode, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE_PX = (1600, 1180)
LAST_MONTH = 24

TITLES = {
    "length_cm": "Length [cm]",
    "weight_kg": "Weight [kg]",
    "head_circumference_cm": "Head circumference [cm]",
    "arm_circumference_cm": "Arm circumference [cm]",
}
"""Label of the vertical axis by indicator."""

SURVEYED = {
    "length_cm": "crown_sole_length",
    "head_circumference_cm": "head_circumference",
    "arm_circumference_cm": "upper_arm_circumference",
}
"""AnthroKids' name of each indicator that it has; it does not have weight by age."""

CAPTION = (
    "mimoc: measured on the compiled models.  WHO: Child Growth Standards (2006, 2007), {population};"
    " arm circumference starts at three months.\n"
    "AnthroKids: means of age groups, at the middle of their months (Snyder et al. 1977);"
    " its birth row is inferred from WHO's birth length and head circumference."
)

POPULATIONS: Mapping[Reference, str] = {"male": "boys", "female": "girls", "mean": "mean of boys and girls"}

WHO_COLOUR, INFANT_COLOUR, SURVEY_COLOUR = "#33669a", "#c8431f", "#6f6f6f"
"""Colours that colour-blind readers can distinguish, also in grey."""

Series = Mapping[str, Sequence[tuple[float, float]]]
"""Pairs of age in months and value, by indicator."""


def check_plot_name(path: str | Path) -> None:
    """Check, before anything is drawn, that the name of a file has the extension of a supported format.

    Raises:
        OutputError: If it has not.
    """
    if Path(path).suffix.lower() not in FORMATS:
        raise OutputError(f"{path}: not a supported format for plots; end it in {', '.join(FORMATS)}")


def plot_growth(series: Series, path: str | Path, reference: Reference = "mean") -> None:
    """Write a plot of an infant's growth with WHO's median and 5th to 95th percentiles, in the format of its name.

    Raises:
        OutputError: If the file cannot be written there.
        MissingExtraError: If matplotlib is not installed.
    """
    check_plot_name(path)
    write_file(path, encode(draw_growth(series, reference), Path(path).suffix.lower()))


def draw_growth(series: Series, reference: Reference = "mean") -> "Figure":
    """Return the figure, with one panel per indicator; panels of indicators that are not in *series* show WHO only.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    figure = new_figure(*SIZE_PX)
    panels = figure.subplots(2, 2, sharex=True)
    for axes, letter, (indicator, title) in zip(panels.flat, "abcd", TITLES.items(), strict=True):
        _draw_panel(axes, indicator, series.get(indicator, ()), reference)
        axes.set_ylabel(title)
        axes.set_title(letter, loc="left", fontweight="bold", pad=4)
    figure.align_ylabels(panels)
    for axes in panels[-1]:
        axes.set_xlabel("Age [months]")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=len(labels), frameon=False)
    caption = CAPTION.format(population=POPULATIONS[reference])
    figure.text(0.5, 0.012, caption, ha="center", va="bottom", fontsize=7.5, color="0.35", linespacing=1.5)
    figure.subplots_adjust(left=0.065, right=0.985, top=0.915, bottom=0.125, wspace=0.15, hspace=0.16)
    return figure


def _draw_panel(axes: "Axes", indicator: str, infant: Sequence[tuple[float, float]], reference: Reference) -> None:
    _draw_standard(axes, load_tables().who[indicator], reference)
    if indicator in SURVEYED:
        points = measure(0).table[SURVEYED[indicator]].points
        _draw_points(axes, [point for point in points if not _is_inferred(point)], "x", "AnthroKids")
        _draw_points(axes, [point for point in points if _is_inferred(point)], "d", "AnthroKids, inferred")
    if infant:
        ages_months, values = zip(*infant, strict=True)
        axes.plot(ages_months, values, "o-", color=INFANT_COLOUR, markersize=4, linewidth=1.3, label="mimoc", zorder=3)
    axes.set_xlim(-0.5, LAST_MONTH + 0.5)
    axes.set_xticks(range(0, LAST_MONTH + 1, 3))
    axes.locator_params(axis="y", integer=True)
    tidy(axes)


def _draw_standard(axes: "Axes", standard: GrowthStandard, reference: Reference) -> None:
    ages_months = [age for age in np.linspace(0, LAST_MONTH, 20 * LAST_MONTH + 1) if standard.covers(age)]
    low, middle, high = (
        [standard.value(NormalDist().inv_cdf(share), age, reference) for age in ages_months]
        for share in (0.05, 0.5, 0.95)
    )
    axes.fill_between(
        ages_months, low, high, color=WHO_COLOUR, alpha=0.18, linewidth=0, label="WHO, 5th to 95th percentile"
    )
    axes.plot(
        ages_months,
        middle,
        color=WHO_COLOUR,
        linewidth=1.8,
        label="WHO, mean" if reference == "mean" else "WHO, median",
    )


def _draw_points(axes: "Axes", points: Sequence[DataPoint], marker: str, label: str) -> None:
    shown = [point for point in points if point.age_months <= LAST_MONTH]
    axes.plot(
        [point.age_months for point in shown],
        [point.value_cm for point in shown],
        marker,
        color=SURVEY_COLOUR,
        markerfacecolor="none",
        markersize=7,
        alpha=0.8,
        label=label,
        zorder=4,
    )


def _is_inferred(point: DataPoint) -> bool:
    return point.origin.startswith(BIRTH)
