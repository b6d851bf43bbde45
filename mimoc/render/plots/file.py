"""Plots as files of pictures, by matplotlib."""

import io
from collections.abc import Mapping, Sequence
from importlib import import_module
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mimoc.base.errors import MissingExtraError, OutputError
from mimoc.bundle.files import write_file
from mimoc.render.plots.plot import Plot, Sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 150
FORMATS: Mapping[str, dict[str, None] | None] = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
    ".jpg": None,
    ".jpeg": None,
    ".webp": None,
}
"""Metadata to remove for each file format, so that the same plots give the same bytes."""
LEGEND_PX, CAPTION_PX = 60, 70
SMALL_PX = 400  # Width below which plots have no labels of their axes but what is drawn upwards as their title.
MAX_COLUMNS = 7  # Maximum number of columns of a legend.
COLOURS, DARKEST, LIGHTEST = "viridis", 0.0, 0.88
"""A colour map that is suitable for colour-blind readers and stays ordered in grey, and its range that is visible on
white."""
MARKERS = "osv^DPX<>"  # Of labels in rows.
BLUE, RED, GREY = "#33669a", "#c8431f", "#6f6f6f"
"""Colours that colour-blind readers can distinguish, also in grey."""
LOOKS: Mapping[str, dict[str, Any]] = {
    "band": {"color": BLUE, "alpha": 0.18},
    "median": {"color": BLUE, "linewidth": 1.8},
    "marked": {"marker": "o", "markersize": 4},
    "infant": {"color": RED, "linewidth": 1.3, "marker": "o", "markersize": 4, "zorder": 3},
    "reached": {"color": RED, "marker": "D", "markersize": 7, "zorder": 3},
    "survey": {"color": GREY, "marker": "x", "markersize": 7, "markerfacecolor": "none", "alpha": 0.8, "zorder": 4},
    "inferred": {"color": GREY, "marker": "d", "markersize": 7, "markerfacecolor": "none", "alpha": 0.8, "zorder": 4},
    "whisker": {"color": GREY, "linewidth": 1.3},
    "law": {"color": "0.75", "zorder": 1},
    "so-far": {"color": "0.55", "linestyle": ":", "marker": "o", "markersize": 3.5, "fillstyle": "none"},
    "window": {"color": BLUE, "alpha": 0.35},
    "usual": {"color": "0.85", "alpha": 1.0, "zorder": 1},
}
"""How parts with a look of their own are drawn; what it does not say, such as the colour, follows from the label."""


def require_matplotlib() -> None:
    """Check that matplotlib is installed; raise a MissingExtraError if it is not."""
    try:
        import_module("matplotlib.figure")
    except ImportError:
        raise MissingExtraError("matplotlib", "report") from None


def check_plot_name(path: str | Path) -> None:
    """Raise an OutputError, before anything is drawn, unless a file's name has the extension of a supported format."""
    if Path(path).suffix.lower() not in FORMATS:
        raise OutputError(f"{path}: not a supported format for plots; end it in {', '.join(FORMATS)}")


def write_sheet(sheet: Sheet, path: str | Path) -> None:
    """Write plots as a picture, in the format of the file's name, or raise an OutputError or MissingExtraError."""
    check_plot_name(path)
    write_file(path, encode(sheet, Path(path).suffix.lower()))


def encode(sheet: Sheet, suffix: str = ".png") -> bytes:
    """Return plots in a format of `FORMATS`, always the same bytes; MissingExtraError without matplotlib."""
    figure = draw(sheet)
    from matplotlib import rc_context

    picture = io.BytesIO()
    with rc_context({"svg.hashsalt": "mimoc"}):
        figure.savefig(picture, format=suffix[1:], dpi=DPI, metadata=FORMATS[suffix])
    return picture.getvalue()


def draw(sheet: Sheet) -> "Figure":
    """Return the figure of some plots, independent of pyplot and any display; MissingExtraError without matplotlib."""
    require_matplotlib()
    from matplotlib.figure import Figure

    columns = sheet.columns or len(sheet.plots)
    rows = -(-len(sheet.plots) // columns)
    labels = [*dict.fromkeys(label for plot in sheet.plots for label in plot.labels)]
    shared = sheet.shared_legend or all(set(plot.labels) == set(labels) for plot in sheet.plots)
    above, below = LEGEND_PX * bool(shared and labels), CAPTION_PX * bool(sheet.caption)
    width, height = columns * sheet.panel_px[0], rows * sheet.panel_px[1] + above + below
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    styles, handles = _styles_of(sheet.plots) if shared else {}, dict[str, Any]()
    for number, plot in enumerate(sheet.plots, start=1):
        axes = figure.add_subplot(rows, columns, number)
        drawn = _draw_plot(axes, plot, styles or _styles_of([plot]))
        handles = {**drawn, **handles}
        if not shared and len(drawn) > 1:
            axes.legend([*drawn.values()], [*drawn], frameon=False)
        _style_axes(axes, plot, is_small=sheet.panel_px[0] < SMALL_PX)
    if above:
        _add_legend(figure, {label: handles[label] for label in labels if label in handles})
    figure.text(0.5, 0.012, sheet.caption, ha="center", va="bottom", fontsize=7.5, color="0.35", linespacing=1.5)
    figure.tight_layout(rect=(0, below / height, 1, 1 - above / height))
    return figure


def _add_legend(figure: "Figure", handles: Mapping[str, Any]) -> None:
    for columns in range(max(1, min(len(handles), MAX_COLUMNS)), 0, -1):
        legend = figure.legend([*handles.values()], [*handles], loc="upper center", ncols=columns, frameon=False)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def _styles_of(plots: Sequence[Plot]) -> dict[str, dict[str, Any]]:
    """Return colour and marker of each label whose parts have no colour of their own, the darkest first."""
    from matplotlib import colormaps

    parts = [part for plot in plots for part in (*plot.lines, *plot.dots, *plot.bands)]
    labels = [*dict.fromkeys(part.label for part in parts if "color" not in LOOKS.get(part.look, {}))]
    shades = colormaps[COLOURS](np.linspace(DARKEST, LIGHTEST, max(1, len(labels))))
    return {
        label: {"color": tuple(shade), "marker": marker}
        for label, shade, marker in zip(labels, shades, cycle(MARKERS), strict=False)
    }


def _draw_plot(axes: "Axes", plot: Plot, styles: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    handles: list[Any] = []
    for line in plot.lines:
        style = {**styles.get(line.label, {}), "marker": "", "linewidth": 1.5, **LOOKS.get(line.look, {})}
        handles += axes.plot(line.x, line.y, label=line.label, **style)
    for dots in plot.dots:
        usual = {"markersize": 7} if dots.look == "row" else {"marker": "o", "markersize": 4}
        style = {"zorder": 3, **styles.get(dots.label, {}), **usual, **LOOKS.get(dots.look, {}), "linestyle": "none"}
        handles += axes.plot(dots.x, dots.y, label=dots.label, **style)
    for band in plot.bands:
        usual = {"color": styles[band.label]["color"]} if band.label in styles else {}
        x, low, high = (np.asarray(edge, float) for edge in (band.x, band.low, band.high))
        style = {**usual, "alpha": 0.2, "linewidth": 0, **LOOKS.get(band.look, {})}
        handles.append(axes.fill_between(x, low, high, label=band.label, **style))
    if plot.level is not None:
        handles.append(axes.axhline(plot.level, color="0.45", linewidth=1.0, linestyle=":", label=plot.level_label))
    if plot.ring is not None:
        angle_rad = np.linspace(0, 2 * np.pi, 181)
        axes.plot(plot.ring * np.cos(angle_rad), plot.ring * np.sin(angle_rad), color="0.45", linestyle=":")
    first = {str(handle.get_label()): handle for handle in reversed(handles)}
    return {label: first[label] for label in plot.labels if label in first}


def _style_axes(axes: "Axes", plot: Plot, *, is_small: bool) -> None:
    if is_small:
        axes.set_title(plot.title or plot.y.title, loc="left", fontsize=7.5)
        axes.tick_params(labelsize=7)
    else:
        axes.set_title(plot.title, loc="left", fontweight="bold", pad=6)
        axes.set_xlabel(plot.x.title)
        axes.set_ylabel(plot.y.title)
    if plot.logarithmic:
        axes.set_xscale("log")
    elif plot.x_ticks is None:
        axes.locator_params(axis="x", nbins=6)
    if plot.equal:
        axes.set_aspect("equal", adjustable="datalim")
    low, high = plot.y_range or plot.y.limits
    room = 0.03 * (high - low) if low is not None and high is not None and plot.y_range is None else 0.0
    if low is not None:
        axes.set_ylim(low - room, None if high is None else high + room)
    if plot.x_range is not None:
        axes.set_xlim(plot.x_range)
    for axis, ticks in ((axes.xaxis, plot.x_ticks), (axes.yaxis, plot.y_ticks)):
        if ticks is not None:
            axis.set_ticks([value for value, _ in ticks], [text for _, text in ticks])
    if not any(np.isfinite(np.asarray(part.y, float)).any() for part in (*plot.lines, *plot.dots)):
        axes.text(0.5, 0.5, "no value so far", transform=axes.transAxes, ha="center", color="0.45")
    axes.grid(color="0.92", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
