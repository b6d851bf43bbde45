"""Plots as values, and as pictures by matplotlib; `drawing.draw_svg` draws them for pages."""

import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MissingExtraError, OutputError
from mimoc.base.quantities import AGE, LEARNING, SO_FAR, TRAINED
from mimoc.base.quantity import Quantity
from mimoc.bundle.files import write_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Ticks = Sequence[tuple[float, str]]  # Values, and what is written beside them.
Range = tuple[float, float]
Numbers = Sequence[float] | npt.NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True)
class Line:
    """A line through points, shape (n,) each."""

    x: Numbers
    y: Numbers
    label: str = ""  # Label in the legend; what has the same label and no look of its own has the same colour.
    look: str = "line"  # Class of the style sheet of pages, and key of `LOOKS`.


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
MIN_WIDTH_MONTHS = 0.6  # Width that the window of a single age is drawn with.

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
    widening = max(0.0, MIN_WIDTH_MONTHS - (oldest - youngest)) / 2
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
            steps = np.asarray(seeds[0]["steps"], float)[:rows][known]
            values = values[:, known]
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
MARKERS = "osv^DPX<>"  # Markers of labels, one after the other.
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
    above = LEGEND_PX * bool(shared and labels)
    below = CAPTION_PX * bool(sheet.caption)
    width = columns * sheet.panel_px[0]
    height = rows * sheet.panel_px[1] + above + below
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    styles = _styles_of(sheet.plots) if shared else {}
    handles = dict[str, Any]()
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
