"""Who an infant is: its size, in numbers, in words and on WHO's growth charts."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mimoc.bundle.manifest import ChildEntry
from mimoc.compiler.provenance import who_percentiles
from mimoc.fits import load_tables
from mimoc.quantities.child import INDICATORS
from mimoc.render.plots.growth import who_chart
from mimoc.render.plots.plot import Dots, Plot
from mimoc.render.plots.svg import draw_svg
from mimoc.reporting import words
from mimoc.reporting.infant.sources import Sources
from mimoc.reporting.page import Drawings, Section, Tile, Tiles

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
        text = "WHO has no standard for this age"
        if indicator in percentiles:
            text = words.rank(indicator, percentiles[indicator], child.sex, child.age_months)
        links = sources.links(f"child.{indicator}", f"who.{indicator}.percentile")
        yield Tile(
            quantity.label, words.quantity(measures[indicator], quantity.unit), f"{words.sentence(text)}.", links
        )


def _chart(indicator: str, child: ChildEntry, percentiles: Mapping[str, float]) -> Plot:
    quantity, value, text = INDICATORS[indicator], getattr(child, indicator), "this infant has none to measure"
    dots: tuple[Dots, ...] = ()
    if value is not None:
        text = f"{words.quantity(value, quantity.unit)} at {words.age(child.age_months)}"
        dots = (Dots((child.age_months,), (value,), "", "infant", (text,), 5.5),)
    if indicator in percentiles:
        text += f", percentile {percentiles[indicator]:.0f}"
    chart = who_chart(indicator, child.sex or "mean", () if value is None else (value,))
    about = f"{quantity.label} by age, WHO percentiles 3 to 97; this infant: {text}"
    return replace(chart, dots=dots, about=about)
