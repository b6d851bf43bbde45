"""An infant's growth over WHO's standards and AnthroKids' (figure 2 of the paper), and milestones by age in rows."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

from mimoc.base.quantities import AGE, INDICATORS, Quantity
from mimoc.fits import load_tables, measure
from mimoc.fits.anthropometry import DataPoint
from mimoc.fits.growth import BIRTH
from mimoc.fits.standards import Reference
from mimoc.render.plots import Band, Dots, Line, Plot, Range, Sheet, Ticks

LAST_MONTH = 24
AGE_RANGE = (-0.5, LAST_MONTH + 0.5)
PERCENTILES = (3, 15, 50, 85, 97)  # Those of WHO's charts.
NAMED = (3, 50, 97)  # Those that are named at the ends of their curves.

SURVEYED = {  # AnthroKids' name of each indicator that it has; it does not have weight by age.
    "length_cm": "crown_sole_length",
    "head_circumference_cm": "head_circumference",
    "arm_circumference_cm": "upper_arm_circumference",
}

GROWTH_CAPTION = (
    "mimoc: measured on the compiled models.  WHO: Child Growth Standards (2006, 2007), {population};"
    " arm circumference starts at three months.\n"
    "AnthroKids: means of age groups, at the middle of their months (Snyder et al. 1977);"
    " its birth row is inferred from WHO's birth length and head circumference."
)
MEASUREMENTS_CAPTION = (
    "mimoc: measured on the compiled models as on children.  AnthroKids: means of age groups, at the middle of their "
    "months (Snyder et al. 1977), with a band of 4 %.  Curve: growth law of the average child."
)
POPULATIONS: Mapping[Reference, str] = {"male": "boys", "female": "girls", "mean": "mean of boys and girls"}

Points = Sequence[tuple[float, float]]  # Pairs of age in months and value.


def growth_sheet(series: Mapping[str, Points], reference: Reference = "mean") -> Sheet:
    """Return plots of an infant's values by indicator, over WHO's median and 5th to 95th percentiles."""
    plots = tuple(
        _growth_plot(indicator, quantity, series.get(indicator, ()), reference, letter)
        for letter, (indicator, quantity) in zip("abcd", INDICATORS.items(), strict=True)
    )
    caption = GROWTH_CAPTION.format(population=POPULATIONS[reference])
    return Sheet(plots, columns=2, panel_px=(800, 525), caption=caption, shared_legend=True)


def who_chart(indicator: str, reference: Reference, values: Sequence[float] = ()) -> Plot:
    """Return WHO's growth chart of one of `INDICATORS`, the median and bands of `PERCENTILES`, with room for values."""
    ages_months, curves = _standard_curves(indicator, PERCENTILES, 0.5, reference)
    low, inner_low, middle, inner_high, high = curves
    shown = (*low, *high, *values)
    return Plot(
        x=AGE,
        y=INDICATORS[indicator],
        lines=(Line(ages_months, middle, "", "median"),),
        bands=(Band(ages_months, low, high, "", "band"), Band(ages_months, inner_low, inner_high, "", "band-inner")),
        x_range=(0.0, LAST_MONTH),
        y_range=(min(shown) * 0.97, max(shown) * 1.02),
        x_ticks=_months(6),
        notes=tuple((LAST_MONTH, curves[PERCENTILES.index(share)][-1], f"{share}") for share in NAMED),
    )


def _standard_curves(
    indicator: str, percentiles: Sequence[float], every_months: float, reference: Reference
) -> tuple[list[float], list[list[float]]]:
    """Return ages, in months, and at each of them the values of WHO's percentiles, one list for each of those."""
    standard = load_tables().who[indicator]
    steps = round(LAST_MONTH / every_months)
    ages_months = [age for step in range(steps + 1) if standard.covers(age := step * every_months)]
    scores = [NormalDist().inv_cdf(percentile / 100) for percentile in percentiles]
    return ages_months, [[standard.value(z, age, reference) for age in ages_months] for z in scores]


def measurements_sheet(series: Mapping[str, Points], tolerance: float) -> Sheet:
    """Return plots of measurements in cm, by AnthroKids name, over the survey's with a relative tolerance."""
    plots = tuple(_measurement_plot(name, points, tolerance) for name, points in sorted(series.items()))
    return Sheet(plots, columns=6, panel_px=(330, 270), caption=MEASUREMENTS_CAPTION, shared_legend=True)


def _growth_plot(indicator: str, quantity: Quantity, infant: Points, reference: Reference, letter: str) -> Plot:
    ages_months, (low, middle, high) = _standard_curves(indicator, (5, 50, 95), 0.05, reference)
    line = Line(ages_months, middle, "WHO, mean" if reference == "mean" else "WHO, median", "median")
    return Plot(
        x=AGE,
        y=quantity,
        lines=(line, *_infant_lines(infant)),
        bands=(Band(ages_months, low, high, "WHO, 5th to 95th percentile", "band"),),
        dots=tuple(_surveyed(indicator)),
        title=letter,
        x_range=AGE_RANGE,
        x_ticks=_months(3),
    )


def _infant_lines(points: Points) -> Iterator[Line]:
    if points:
        yield Line([age for age, _ in points], [value for _, value in points], "mimoc", "infant")


def _surveyed(indicator: str) -> Iterator[Dots]:
    if indicator in SURVEYED:
        points = _survey_points(SURVEYED[indicator])
        yield _dots([point for point in points if not point.origin.startswith(BIRTH)], "AnthroKids", "survey")
        inferred = [point for point in points if point.origin.startswith(BIRTH)]
        yield _dots(inferred, "AnthroKids, inferred", "inferred")


def _survey_points(name: str) -> list[DataPoint]:
    return [point for point in measure(0).table[name].points if point.age_months <= LAST_MONTH]


def _measurement_plot(name: str, points: Points, tolerance: float) -> Plot:
    means = load_tables().anthrokids.get(name, ())
    surveyed = _survey_points(name)[-len(means) :] if means else []
    ages_months = [quarter / 4 for quarter in range(4 * LAST_MONTH + 1)]
    law = Line(ages_months, [100 * measure(age)[name] for age in ages_months], "curve", "law")
    whiskers = [
        Line((point.age_months,) * 2, [(1 + side * tolerance) * point.value_cm for side in (-1, 1)], "", "whisker")
        for point in surveyed
    ]
    return Plot(
        x=AGE,
        y=Quantity(f"{name}_cm", name.replace("_", " ").capitalize(), "cm"),
        lines=(law, *_infant_lines(points), *whiskers),
        dots=(_dots(surveyed, "AnthroKids", "survey"),) if means else (),
        x_range=AGE_RANGE,
        x_ticks=_months(6),
    )


def _dots(points: Sequence[DataPoint], label: str, look: str) -> Dots:
    return Dots([point.age_months for point in points], [point.value_cm for point in points], label, look)


def _months(every: int) -> Ticks:
    return [(float(month), f"{month}") for month in range(0, LAST_MONTH + 1, every)]


WIDTH_PX, ROW_PX, FRAME_PX = 1400, 100, 180
SPREAD = 0.55  # Height that the marks of a row are spread over, by that of a row.
BAR = 0.6  # Height of a bar, by that of a row.
ROWS = Quantity("row", "")


@dataclass(frozen=True, slots=True)
class AgeRow:
    """Ages at which one thing is reached."""

    label: str
    ages_months: Mapping[str, float | None]
    """The age by the label of its mark; all rows have the same labels. None if it is not reached."""
    usual_months: tuple[float, ...] = ()
    """When it is usually reached: the youngest age, the median if it is known, and the oldest."""


def rows_sheet(
    rows: Sequence[AgeRow], usual: str, looks: tuple[str, str] = ("usual", "row"), ages_months: Range = AGE_RANGE
) -> Sheet:
    """Return a plot with a row of marks for each thing, the first at the top, over *ages_months*.

    Bars of *usual* ages, in which a line is the median, and marks have the two looks.
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
