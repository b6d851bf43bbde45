"""Curves in panels side by side: what most experiments measure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from mimoc.render.plots.figure import new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL_PX = (800, 640)
LEGEND_PX = 60
"""Height that one legend takes above all panels."""
MOST_COLUMNS = 7
"""Of labels in it."""
COLOURS = "viridis"
"""Matplotlib's name of a scale whose order colour-blind readers see too, and which stays ordered in grey."""
DARKEST, LIGHTEST = 0.0, 0.88
"""What of the scale shows on white."""


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve, or some points."""

    label: str
    """What the legend says; curves of one label have one colour."""
    x: npt.ArrayLike
    """Shape (n,)."""
    y: npt.ArrayLike
    """Shape (n,)."""
    spread: tuple[npt.ArrayLike, npt.ArrayLike] | None = None
    """Lower and upper edge of a band about the curve, shape (n,) each."""
    marker: str = ""
    """Matplotlib's marker on each point; none for a line alone."""
    joined: bool = True
    """Whether a line goes from point to point."""


@dataclass(frozen=True, slots=True)
class Panel:
    """Curves over the same axes."""

    x_label: str
    """With its unit."""
    y_label: str
    """Likewise."""
    curves: Sequence[Curve]
    title: str = ""
    level: float | None = None
    """A height that is marked across the panel."""
    ring: float | None = None
    """Radius of a circle about the origin that is marked."""
    equal: bool = False
    """Whether a unit is as long on both axes, as on a map."""
    logarithmic: bool = False
    """Whether the horizontal axis is."""


def draw_panels(panels: Sequence[Panel], panel_px: tuple[int, int] = PANEL_PX) -> "Figure":
    """Return a figure of panels in a row, below one legend if all have the same labels, else each with its own.

    Labels have colours in the order in which they first appear in a panel, the darkest first.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    width_px, height_px = panel_px
    shared = len({tuple(_labels(panel)) for panel in panels}) == 1
    legend_px = LEGEND_PX if shared else 0
    figure = new_figure(width_px * len(panels), height_px + legend_px)
    row = figure.subplots(1, len(panels), squeeze=False)[0]
    for axes, panel in zip(row, panels, strict=True):
        _draw_panel(axes, panel)
        if not shared and len(_labels(panel)) > 1:
            axes.legend(*_legend(axes), frameon=False)
    if shared:
        handles, labels = _legend(row[0])
        figure.legend(handles, labels, loc="upper center", ncols=max(1, min(len(labels), MOST_COLUMNS)), frameon=False)
    figure.tight_layout(rect=(0, 0, 1, height_px / (height_px + legend_px)))
    return figure


def _labels(panel: Panel) -> list[str]:
    return list(dict.fromkeys(curve.label for curve in panel.curves))


def _legend(axes: "Axes") -> tuple[list[Any], list[str]]:
    """Return the handle of each label's first curve, and the labels."""
    handles, labels = axes.get_legend_handles_labels()
    first = dict(zip(reversed(labels), reversed(handles), strict=True))
    ordered = list(dict.fromkeys(labels))
    return [first[label] for label in ordered], ordered


def _colours(count: int) -> Sequence[tuple[float, ...]]:
    from matplotlib import colormaps

    return [tuple(colour) for colour in colormaps[COLOURS](np.linspace(DARKEST, LIGHTEST, count))]


def _draw_panel(axes: "Axes", panel: Panel) -> None:
    labels = _labels(panel)
    colours = dict(zip(labels, _colours(len(labels)), strict=True))
    for curve in panel.curves:
        _draw_curve(axes, curve, colours[curve.label])
    if panel.level is not None:
        axes.axhline(panel.level, color="0.45", linewidth=1.0, linestyle=":")
    if panel.ring is not None:
        angle_rad = np.linspace(0, 2 * np.pi, 181)
        axes.plot(panel.ring * np.cos(angle_rad), panel.ring * np.sin(angle_rad), color="0.45", linestyle=":")
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    axes.set_title(panel.title, loc="left", fontweight="bold", pad=6)
    if panel.logarithmic:
        axes.set_xscale("log")
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
    tidy(axes)


def _draw_curve(axes: "Axes", curve: Curve, colour: tuple[float, ...]) -> None:
    line = "-" if curve.joined else "none"
    axes.plot(
        curve.x, curve.y, linestyle=line, marker=curve.marker, color=colour, linewidth=1.5, ms=4, label=curve.label
    )
    if curve.spread is not None:
        low, high = map(np.asarray, curve.spread)
        axes.fill_between(np.asarray(curve.x), low, high, color=colour, alpha=0.2, linewidth=0)
