"""Who an infant is: its size, in numbers, in words and on WHO's growth charts."""

from collections.abc import Iterator, Mapping
from statistics import NormalDist

from mimoc.bundle.manifest import ChildEntry
from mimoc.compiler.provenance.child import who_percentiles
from mimoc.fits import GrowthStandard, load_tables
from mimoc.fits.curves import LAST_MONTH
from mimoc.fits.who import Reference
from mimoc.quantities.child import AGE, INDICATORS
from mimoc.reporting import words
from mimoc.reporting.drawing import Drawing, dot, label
from mimoc.reporting.frame import Frame
from mimoc.reporting.infant.sources import Sources
from mimoc.reporting.page import Drawings, Section, Tile, Tiles

PERCENTILES = (3, 15, 50, 85, 97)
"""Curves of WHO's charts."""
NAMED = (3, 50, 97)
"""Those that are named at their ends."""
EVERY_MONTHS = 0.5
"""Ages at which the curves are drawn."""
RIGHT = 30.0
"""Room for what the curves are called."""
MONTHS = [(float(month), str(month)) for month in range(0, int(LAST_MONTH) + 1, 6)]
AMONG = {
    "male": "boys",
    "female": "girls",
    None: "the mean of boys and girls, since this infant is the mean of both",
}


def growth(child: ChildEntry, sources: Sources) -> Section:
    """Return the section on an infant's size."""
    percentiles = who_percentiles(child)
    charts = [_chart(indicator, child, percentiles) for indicator in load_tables().who]
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


def _chart(indicator: str, child: ChildEntry, percentiles: Mapping[str, float]) -> Drawing:
    standard, quantity = load_tables().who[indicator], INDICATORS[indicator]
    curves = _curves(standard, child.sex or "mean")
    value, months = getattr(child, indicator), [age for age, _ in curves[PERCENTILES[0]]]
    shown = [v for curve in curves.values() for _, v in curve] + ([] if value is None else [value])
    frame = Frame((0.0, LAST_MONTH), (min(shown) * 0.97, max(shown) * 1.02), right=RIGHT)
    low, inner_low, middle, inner_high, high = ([v for _, v in curves[each]] for each in PERCENTILES)
    paths = [
        frame.band(months, low, high, "band"),
        frame.band(months, inner_low, inner_high, "band-inner"),
        frame.line(zip(months, middle, strict=True), "median"),
    ]
    ends = [(frame.at(LAST_MONTH, curves[each][-1][1]), str(each)) for each in NAMED]
    names = [label((x + 5, y + 4), text, "small start") for (x, y), text in ends]
    dots, told = [], "this infant has none to measure"
    if value is not None:
        told = f"{words.quantity(value, quantity.unit)} at {words.age(child.age_months)}"
        dots = [dot(frame.at(child.age_months, value), "infant", 5.5, told)]
    if indicator in percentiles:
        told += f", percentile {percentiles[indicator]:.0f}"
    about = f"{quantity.label} by age, WHO percentiles 3 to 97; this infant: {told}"
    return frame.draw(quantity.title, AGE.heading, paths, dots, names, MONTHS, about)


def _curves(standard: GrowthStandard, reference: Reference) -> dict[int, list[tuple[float, float]]]:
    """Return age and value along each percentile."""
    ages = [step * EVERY_MONTHS for step in range(int(LAST_MONTH / EVERY_MONTHS) + 1)]
    known = [age for age in ages if standard.covers(age)]
    scores = {each: NormalDist().inv_cdf(each / 100) for each in PERCENTILES}
    return {each: [(age, standard.value(z, age, reference)) for age in known] for each, z in scores.items()}
