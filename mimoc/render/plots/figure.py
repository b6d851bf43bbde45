"""Matplotlib figures and their image files."""

import io
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING

from mimoc.errors import MissingExtraError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 150
FORMATS: Mapping[str, dict[str, None] | None] = {
    ".png": None,
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
    ".jpg": None,
    ".jpeg": None,
    ".webp": None,
}
"""Metadata to remove for each file format, so that the same figure gives the same bytes."""


def new_figure(width_px: int, height_px: int) -> "Figure":
    """Return an empty figure that is independent of pyplot and of any display.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    require_matplotlib()
    from matplotlib.figure import Figure

    return Figure(figsize=(width_px / DPI, height_px / DPI), dpi=DPI)


def require_matplotlib() -> None:
    """Check that matplotlib is installed.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    try:
        import_module("matplotlib.figure")
    except ImportError:
        raise MissingExtraError("matplotlib", "report") from None


def png(figure: "Figure") -> bytes:
    """Return a figure as a PNG; the same figure gives the same bytes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    picture = io.BytesIO()
    FigureCanvasAgg(figure).print_png(picture, metadata={"Software": None})
    return picture.getvalue()


def encode(figure: "Figure", suffix: str) -> bytes:
    """Return a figure in a format of `FORMATS`; the same figure gives the same bytes."""
    if suffix == ".png":
        return png(figure)
    from matplotlib import rc_context

    picture = io.BytesIO()
    with rc_context({"svg.hashsalt": "mimoc"}):
        figure.savefig(picture, format=suffix[1:], dpi=DPI, metadata=FORMATS[suffix])
    return picture.getvalue()


def tidy(axes: "Axes") -> None:
    """Give a panel a light grid in the background and remove the frame at the top and on the right."""
    axes.grid(color="0.92", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
