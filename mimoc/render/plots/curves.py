"""Figures of curves in panels side by side."""

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
"""Height of a legend above all panels."""
MAX_COLUMNS = 7
"""Maximum number of columns of the legend."""
COLOURS = "viridis"
"""Matplotlib's name of a colour map that is suitable for colour-blind readers and stays ordered in grey."""
DARKEST, LIGHTEST = 0.0, 0.88
"""Range of the colour map that is visible on white."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve or a set of points."""

    label: str
    """Label in the legend; curves with the same label have the same colour."""
    x: npt.ArrayLike
    """Shape (n,)."""
    y: npt.ArrayLike
    """Shape (n,)."""
    band: tuple[npt.ArrayLike, npt.ArrayLike] | None = None
    """Lower and upper edge of a band around the curve, shape (n,) each."""
    marker: str = ""
    """Matplotlib's marker of the points; empty for none."""
    joined: bool = True
    """Whether the points are joined by a line."""


@dataclass(frozen=True, slots=True)
class Panel:
    """Curves in the same axes."""

    x_label: str
    """Label of the horizontal axis, with its unit."""
    y_label: str
    """Label of the vertical axis, with its unit."""
    curves: Sequence[Curve]
    title: str = ""
    level: float | None = None
    """Value marked by a horizontal line."""
    ring: float | None = None
    """Radius of a circle marked around the origin."""
    equal: bool = False
    """Whether both axes have the same scale."""
    logarithmic: bool = False
    """Whether the horizontal axis is logarithmic."""


def draw_panels(panels: Sequence[Panel], panel_px: tuple[int, int] = PANEL_PX) -> "Figure":
    """Return a figure of panels in a row, with a shared legend if all have the same labels, otherwise one for each.

    Colours are assigned to labels in the order of their first appearance in a panel, the darkest first.

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
        figure.legend(handles, labels, loc="upper center", ncols=max(1, min(len(labels), MAX_COLUMNS)), frameon=False)
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


def colours_of(count: int) -> Sequence[tuple[float, ...]]:
    """Return colours of curves or marks, the darkest first."""
    from matplotlib import colormaps

    return [tuple(colour) for colour in colormaps[COLOURS](np.linspace(DARKEST, LIGHTEST, count))]


def _draw_panel(axes: "Axes", panel: Panel) -> None:
    labels = _labels(panel)
    colours = dict(zip(labels, colours_of(len(labels)), strict=True))
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
    if curve.band is not None:
        low, high = map(np.asarray, curve.band)
        axes.fill_between(np.asarray(curve.x), low, high, color=colour, alpha=0.2, linewidth=0)
