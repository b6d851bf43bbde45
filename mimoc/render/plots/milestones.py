"""Ages in rows: when something is reached, beside when it usually is, as in WHO's chart of motor milestones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mimoc.quantities import Quantity
from mimoc.quantities.child import AGE
from mimoc.render.plots.growth import AGE_RANGE
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Range, Sheet

WIDTH_PX, ROW_PX, FRAME_PX = 1400, 100, 180
SPREAD = 0.55
"""Height that the marks of a row are spread over, by that of a row."""
BAR = 0.6
"""Height of a bar, by that of a row."""
ROWS = Quantity("row", "")


@dataclass(frozen=True, slots=True)
class AgeRow:
    """Ages at which one thing is reached."""

    label: str
    ages_months: Mapping[str, float | None]
    """By the label of the mark, the same in all rows; None if it is not reached."""
    usual_months: tuple[float, ...] = ()
    """When it is usually reached: the youngest age, the median if it is known, and the oldest."""


def rows_sheet(
    rows: Sequence[AgeRow], usual: str, looks: tuple[str, str] = ("usual", "row"), ages_months: Range = AGE_RANGE
) -> Sheet:
    """Return a plot with a row of marks for each thing, the first at the top.

    Args:
        rows: The rows.
        usual: Label of the bars of usual ages, in which a line is the median.
        looks: Looks of bars and marks.
        ages_months: Ends of the axis.
    """
    lines: list[Line] = []
    bands: list[Band] = []
    for place, row in enumerate(rows):
        if row.usual_months:
            youngest, *median, oldest = row.usual_months
            edges = (place - BAR / 2,) * 2, (place + BAR / 2,) * 2
            bands.append(Band((youngest, oldest), *edges, usual, looks[0]))
            lines += [Line((age, age), (place - BAR / 2, place + BAR / 2), "", "median") for age in median]
    labels = list(rows[0].ages_months)
    offsets = [SPREAD * (index / max(1, len(labels) - 1) - 0.5) * (len(labels) > 1) for index in range(len(labels))]
    dots = []
    for label, offset in zip(labels, offsets, strict=True):
        ages = [(age, place + offset) for place, row in enumerate(rows) if (age := row.ages_months[label]) is not None]
        dots.append(Dots([age for age, _ in ages], [place for _, place in ages], label, looks[1]))
    plot = Plot(
        x=AGE,
        y=ROWS,
        lines=tuple(lines),
        bands=tuple(bands),
        dots=tuple(dots),
        x_range=ages_months,
        y_range=(len(rows) - 0.5, -0.5),
        y_ticks=[(float(place), row.label) for place, row in enumerate(rows)],
    )
    return Sheet((plot,), panel_px=(WIDTH_PX, FRAME_PX + ROW_PX * len(rows)), shared_legend=True)
