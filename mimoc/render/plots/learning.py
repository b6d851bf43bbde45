"""Plots of learning curves."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from mimoc.render.plots.figure import new_figure, png, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE_PX = (1600, 1100)
COLOURS = ("#33669a", "#c8431f", "#3f7f4f", "#8a5a9e", "#b58a1b", "#6f6f6f")
"""Colours that colour-blind readers can distinguish together with the line styles."""
STYLES = ("-", "--", "-.", ":")

PANELS = {
    "time_to_success_s": "Time to success [s]",
    "success_rate": "Success rate",
    "episode_return": "Return of an episode",
    "episode_steps": "Length of an episode [control steps]",
}
"""Label of the vertical axis by column."""
UNFINISHED = {"episode_return": "unfinished_return", "episode_steps": "unfinished_steps"}
"""Column with what there is so far of episodes that have not ended, by that of those that have."""

Columns = Mapping[str, Sequence[float] | np.ndarray]
"""Columns of a learning curve by name, all of the same length, including `steps`."""


def curves_png(
    curves: Mapping[str, Sequence[Columns]], levels: Mapping[str, float] | None = None, level: str = "random policy"
) -> bytes:
    """Return a plot of learning curves as a PNG.

    Args:
        curves: Curves of one or more seeds by label in the legend; the line is their mean, the band their range. A
            single one is drawn with what there is so far of episodes that have not ended.
        levels: Values to compare with, by column, drawn as dashed lines.
        level: Label of these lines.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    return png(draw_curves(curves, levels, level))


def draw_curves(
    curves: Mapping[str, Sequence[Columns]], levels: Mapping[str, float] | None = None, level: str = "random policy"
) -> "Figure":
    """Return the figure, a panel for each column; see `curves_png`.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    figure = new_figure(*SIZE_PX)
    panels, drawn = figure.subplots(2, 2, sharex=True), [columns for seeds in curves.values() for columns in seeds]
    for axes, (column, title) in zip(panels.flat, PANELS.items(), strict=True):
        for number, (label, seeds) in enumerate(curves.items()):
            _draw_seeds(axes, seeds, column, COLOURS[number % len(COLOURS)], STYLES[number % len(STYLES)], label)
        if len(drawn) == 1:
            _draw_unfinished(axes, drawn[0], UNFINISHED.get(column, ""))
        if levels and column in levels:
            axes.axhline(levels[column], color="0.35", linestyle=(0, (4, 3)), linewidth=1.2, label=level)
        _style_axes(axes, column, title)
    panels.flat[0].set_xlim(0, 1.02 * max((max(columns["steps"], default=1) for columns in drawn), default=1))
    for axes in panels[-1]:
        axes.set_xlabel("Control steps of training")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    has_legend = any(labels)
    if has_legend:
        figure.legend(handles, labels, loc="upper center", ncols=len(labels), frameon=False)
    figure.subplots_adjust(
        left=0.07, right=0.985, top=0.93 if has_legend else 0.97, bottom=0.075, wspace=0.17, hspace=0.1
    )
    return figure


def _draw_seeds(axes: "Axes", seeds: Sequence[Columns], column: str, colour: str, style: str, label: str) -> None:
    """Draw mean and range over the seeds, ignoring NaN."""
    rows = min((len(columns["steps"]) for columns in seeds), default=0)
    if rows == 0:
        return
    steps = np.asarray(seeds[0]["steps"], float)[:rows]
    values = np.array([np.asarray(columns[column], float)[:rows] for columns in seeds])
    known = np.isfinite(values).any(axis=0)
    steps, values = steps[known], values[:, known]
    if len(seeds) > 1:
        axes.fill_between(
            steps, np.nanmin(values, axis=0), np.nanmax(values, axis=0), color=colour, alpha=0.18, linewidth=0
        )
    marker = "o" if len(steps) == 1 else ""
    axes.plot(steps, np.nanmean(values, axis=0), style, color=colour, linewidth=1.6, marker=marker, label=label)


def _draw_unfinished(axes: "Axes", columns: Columns, column: str) -> None:
    """Draw what there is so far of episodes that have not ended, and say that it is that."""
    values = np.asarray(columns.get(column, ()), float)
    if np.isfinite(values).any():
        (drawn,) = axes.plot(
            columns["steps"], values, "o:", color="0.55", linewidth=1, markersize=3.5, fillstyle="none"
        )
        axes.legend([drawn], ["so far, of unfinished episodes"], loc="best", frameon=False)


def _style_axes(axes: "Axes", column: str, title: str) -> None:
    axes.set_ylabel(title)
    if column == "success_rate":
        axes.set_ylim(-0.03, 1.03)
    elif column != "episode_return":
        axes.set_ylim(bottom=0)
    if not any(np.isfinite(np.asarray(line.get_ydata(), float)).any() for line in axes.lines):
        axes.text(0.5, 0.5, "no value so far", transform=axes.transAxes, ha="center", color="0.45")
    axes.ticklabel_format(axis="x", style="plain")
    axes.locator_params(axis="x", nbins=5)
    tidy(axes)
