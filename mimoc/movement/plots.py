"""Plots of measures of movement beside those of a sample, and of hip and knee against each other."""

from collections.abc import Sequence
from pathlib import Path

from mimoc.base.errors import MovementError
from mimoc.base.quantities import Quantity
from mimoc.base.quantities.movement import CORE
from mimoc.movement.filming import Filmed
from mimoc.movement.joints import joint_angles
from mimoc.movement.report import MovementMeasures
from mimoc.render.plots.file import write_sheet
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Sheet

COLUMNS, PANEL_PX = 7, (390, 300)
PHASE_PX = 420, 400
MOST_PHASES = 12
INFANT = Quantity("infant", "Infant", about="Which of the infants that were measured", steps=())
HIP = Quantity("hip_deg", "Angle of the hip", "°", "between trunk and thigh; 180 if straight", steps=())
KNEE = Quantity("knee_deg", "Angle of the knee", "°", "between thigh and shank; 180 if straight", steps=())


def write_measures(measured: MovementMeasures, path: str | Path) -> None:
    """Draw the 21 measures, a plot each: a dot for every infant, and a band of the sample's mean +- 2 SD.

    Raises an OutputError or MissingExtraError if the file cannot be written or matplotlib is missing.
    """
    caption = ""
    if measured.distance is not None and measured.sample:
        caption = f"Distance of the mean to {measured.sample.name}: {measured.distance:.2f}"
    plots = tuple(_measure(measured, quantity) for quantity in CORE)
    write_sheet(Sheet(plots, COLUMNS, PANEL_PX, caption, shared_legend=True), path)


def _measure(measured: MovementMeasures, quantity: Quantity) -> Plot:
    values = [one[quantity.name] for one in measured.infants]
    ends, bands, shown = (0.5, len(values) + 0.5), (), list(values)
    if measured.sample:
        mean, deviation = (part[quantity.name] for part in (measured.sample.means, measured.sample.deviations))
        low, high = mean - 2 * deviation, mean + 2 * deviation
        narrow = Band(ends, (mean - deviation,) * 2, (mean + deviation,) * 2, "mean ± 1 SD", "window")
        bands, shown = (Band(ends, (low,) * 2, (high,) * 2, "mean ± 2 SD", "band"), narrow), [*values, low, high]
    room = 0.08 * (max(shown) - min(shown) or 1.0)
    dots = Dots([*range(1, len(values) + 1)], values, "measured", "row")
    y_range = (min(shown) - room, max(shown) + room)
    return Plot(INFANT, quantity, bands=bands, dots=(dots,), x_range=ends, x_ticks=(), y_range=y_range)


def write_phases(films: Sequence[Filmed], path: str | Path) -> None:
    """Draw the angle of the knee over that of the hip, a plot for each infant, a line for each leg.

    Raises a MovementError if no infant's points are known in space, and what `write_measures` does.
    """
    plots = []
    for film in films[:MOST_PHASES]:
        angles = joint_angles(film.space or film.seen)
        if angles:
            lines = tuple(Line(angles[f"{side}_hip"], angles[f"{side}_knee"], side) for side in ("left", "right"))
            plots.append(Plot(HIP, KNEE, lines, title=film.seen.name))
    if not plots:
        raise MovementError("--phase needs angles of hip and knee: simulated infants, or points in space")
    write_sheet(Sheet(tuple(plots), min(4, len(plots)), PHASE_PX), path)
