"""Who an infant is: its size, in numbers, in words and on WHO's growth charts."""

from collections.abc import Iterator, Mapping

from mimoc.bundle.manifest import ChildEntry
from mimoc.compiler.provenance.child import who_percentiles
from mimoc.fits import load_tables
from mimoc.fits.curves import LAST_MONTH
from mimoc.quantities.child import AGE, INDICATORS
from mimoc.render.plots.growth import standard_curves
from mimoc.render.plots.plot import Band, Dots, Line, Plot
from mimoc.render.plots.svg import draw_svg
from mimoc.reporting import words
from mimoc.reporting.infant.sources import Sources
from mimoc.reporting.page import Drawings, Section, Tile, Tiles

PERCENTILES = (3, 15, 50, 85, 97)
"""Curves of WHO's charts."""
NAMED = (3, 50, 97)
"""Those that are named at their ends."""
EVERY_MONTHS = 0.5
"""Ages at which the curves are drawn."""
MONTHS = [(float(month), str(month)) for month in range(0, int(LAST_MONTH) + 1, 6)]
AMONG = {
    "male": "boys",
    "female": "girls",
    None: "the mean of boys and girls, since this infant is the mean of both",
}


def growth(child: ChildEntry, sources: Sources) -> Section:
    """Return the section on an infant's size."""
    percentiles = who_percentiles(child)
    charts = [draw_svg(_chart(indicator, child, percentiles)) for indicator in load_tables().who]
    caption = (
        f"WHO Child Growth Standards (2006, 2007), {AMONG[child.sex]}. The line is the median; 7 of 10 children "
        "are in the inner band, and 94 of 100 in the outer one. The dot is this infant."
    )
    tiles = Tiles(tuple(_tiles(child, percentiles, sources)))
    return Section("size", "Size", (tiles, Drawings(tuple(charts), caption, "pair")))


def _tiles(child: ChildEntry, percentiles: Mapping[str, float], sources: Sources) -> Iterator[Tile]:
    measures = child.model_dump()
    for indicator, quantity in INDICATORS.items():
        if measures[indicator] is None:
            continue
        told = "WHO has no standard for this age"
        if indicator in percentiles:
            told = words.rank(indicator, percentiles[indicator], child.sex, child.age_months)
        links = sources.links(f"child.{indicator}", f"who.{indicator}.percentile")
        yield Tile(
            quantity.label, words.quantity(measures[indicator], quantity.unit), f"{words.sentence(told)}.", links
        )


def _chart(indicator: str, child: ChildEntry, percentiles: Mapping[str, float]) -> Plot:
    standard, quantity = load_tables().who[indicator], INDICATORS[indicator]
    months, curves = standard_curves(standard, PERCENTILES, EVERY_MONTHS, child.sex or "mean")
    low, inner_low, middle, inner_high, high = curves
    value, dots, text = getattr(child, indicator), (), "this infant has none to measure"
    if value is not None:
        text = f"{words.quantity(value, quantity.unit)} at {words.age(child.age_months)}"
        dots = (Dots((child.age_months,), (value,), "", "infant", (text,), 5.5),)
    if indicator in percentiles:
        text += f", percentile {percentiles[indicator]:.0f}"
    shown = [*low, *high, *([] if value is None else [value])]
    return Plot(
        x=AGE,
        y=quantity,
        lines=(Line(months, middle, "", "median"),),
        bands=(Band(months, low, high, "", "band"), Band(months, inner_low, inner_high, "", "band-inner")),
        dots=dots,
        about=f"{quantity.label} by age, WHO percentiles 3 to 97; this infant: {text}",
        x_range=(0.0, LAST_MONTH),
        y_range=(min(shown) * 0.97, max(shown) * 1.02),
        x_ticks=MONTHS,
        notes=tuple((LAST_MONTH, curves[PERCENTILES.index(share)][-1], f"{share}") for share in NAMED),
    )
