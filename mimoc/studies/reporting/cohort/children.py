"""The children of a cohort: who they are, and how the infants look that were built."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import HEAD, LENGTH, WEIGHT
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.render.plots.drawing import Drawing, draw_svg, label
from mimoc.render.plots.plot import Dots, Plot
from mimoc.studies.cohorts import Job
from mimoc.studies.cohorts.store import Store
from mimoc.studies.reporting import words
from mimoc.studies.reporting.page import Block, Cell, Details, Drawings, Section, TextBlock, number, table
from mimoc.studies.reporting.silhouette import Silhouette, silhouette

MOST_DRAWN = 12  # Infants that are drawn, evenly chosen from all.
MOST_LISTED = 200
NOT_OF_BODIES = ("actuation.", "delays.", "noise.", "senses.", "scene.", "control.", "task.")
"""How keys of the spec begin that leave the body as it is."""
UNITS_PER_M = 240.0
BELOW, ABOVE = 36.0, 12.0  # Room below the drawn infants and above.
LEAST_HALF = 34.0  # Half of the least width, so that there is room for the words below.
SEXES = {"female": "girl", "male": "boy"}
LENGTH_RANK, WEIGHT_RANK, HEAD_RANK = (
    Quantity(f"{label.lower()}_percentile", label, "percentile", limits=(0.0, 100.0))
    for label in ("Length", "Weight", "Head")
)
LENGTHS = {quantity.key: quantity for quantity in (LENGTH_RANK, LENGTH)}
AGAINST_LENGTH = {quantity.key: quantity for quantity in (WEIGHT_RANK, WEIGHT, HEAD_RANK, HEAD)}
"""Quantities by the keys of an individual; each of these is drawn against each of LENGTHS."""


def children(jobs: Sequence[Job], store: Store) -> Section | None:
    """Return the section on the children of a cohort, None if it has only one infant of which nothing is known."""
    known = _individuals(jobs)
    blocks = (*_scatters(known), *_outlines(jobs, store), *_list(known))
    return Section("children", "The children", blocks) if blocks else None


def _individuals(jobs: Sequence[Job]) -> dict[int, Mapping[str, Any]]:
    known: dict[int, dict[str, Any]] = {}
    for job in jobs:
        child = job.factors.get("child")
        if isinstance(child, int):
            factors = {name: value for name, value in job.factors.items() if "." not in name and name != "age_months"}
            before = known.setdefault(child, factors)
            known[child] = {name: value for name, value in before.items() if factors.get(name) == value}
    return dict(sorted(known.items()))


def _scatters(known: Mapping[int, Mapping[str, Any]]) -> Iterator[Block]:
    plots = []
    for x, y in product(LENGTHS, AGAINST_LENGTH):
        both = [child for child in known.values() if {x, y} <= child.keys()]
        if len({(child[x], child[y]) for child in both}) > 1:
            plots.append(_scatter(both, x, y))
    if plots:
        caption = f"{words.count(len(known), 'child', 'children')} of the cohort; girls orange, boys blue."
        yield Drawings(tuple(plots), caption, "pair")


def _scatter(known: Sequence[Mapping[str, Any]], x: str, y: str) -> Drawing:
    length, other = LENGTHS[x], AGAINST_LENGTH[y]
    across, up = length.label.lower(), other.label.lower()
    dots: list[Dots] = []
    for child in known:
        text = f"child {child['child']}: {across} {words.figure(child[x])}, {up} {words.figure(child[y])}"
        kind = SEXES.get(child.get("sex", ""), "mean")
        dots.append(Dots((child[x],), (child[y],), "", kind, (text,), 4.0))
    title = f"{other.label} by {across}{other.title.removeprefix(other.label)}"
    return draw_svg(Plot(length, other, dots=tuple(dots), title=title, about=f"{title} of {len(dots)} children"))


def _list(known: Mapping[int, Mapping[str, Any]]) -> Iterator[Block]:
    if known:
        names = [*dict.fromkeys(name for child in known.values() for name in child)]
        rows = [[_cell(child.get(name)) for name in names] for child in list(known.values())[:MOST_LISTED]]
        more = f", the first {MOST_LISTED} of them" if len(known) > MOST_LISTED else ""
        yield Details(f"All {len(known)} children{more}", (table([words.name(name) for name in names], rows),))


def _cell(value: Any) -> Cell:
    if isinstance(value, float):
        return number(words.figure(value))
    return number(f"{value}") if isinstance(value, int) else Cell("" if value is None else str(value))


def _outlines(jobs: Sequence[Job], store: Store) -> Iterator[Block]:
    built = [job for job in jobs if job.step == "build" and (result := store.read(job)) and result.ok]
    if not built:
        yield TextBlock("No infants are drawn, because the cohort has no step that builds them (do: [build]).", "note")
        return
    first: dict[str, Job] = {}
    for job in built:
        first.setdefault(_body(job), job)
    bodies = sorted(first.values(), key=_months)
    number_drawn = min(len(bodies), MOST_DRAWN)
    chosen = [bodies[index * len(bodies) // number_drawn] for index in range(number_drawn)]
    drawn = [(bundle, silhouette(load_model(bundle))) for job in chosen for bundle in _bundle(job, store)]
    if not drawn:
        yield TextBlock("No infants are drawn, because their bundles are no longer in the folder.", "note")
        return
    drawn.sort(key=lambda item: item[0].manifest.child.age_months)
    some = f"{len(drawn)} of the {len(bodies)} bodies" if len(drawn) < len(bodies) else "The bodies"
    tallest_m = max(outline.height_m for _, outline in drawn)
    row = tuple(_outline(bundle, outline, tallest_m) for bundle, outline in drawn)
    yield Drawings(row, f"{some} that were built, to scale, from the solids that the simulation uses.", "row")


def _months(job: Job) -> float:
    """Return the age of an infant, as far as it is a factor, so that infants of all ages are chosen."""
    months = job.factors.get("age_months")
    return float(months) if isinstance(months, (int, float)) else 0.0


def _body(job: Job) -> str:
    """Return what jobs have in common whose infants have the same body, as far as their factors tell."""
    return str(sorted((name, str(value)) for name, value in job.factors.items() if not name.startswith(NOT_OF_BODIES)))


def _bundle(job: Job, store: Store) -> Iterator[Bundle]:
    try:
        yield store.read_bundle(job)
    except MimocError:
        return


def _outline(bundle: Bundle, outline: Silhouette, tallest_m: float) -> Drawing:
    """Return an infant with its age and its length, on the same ground as the tallest one."""
    half = max(UNITS_PER_M * outline.half_width_m, LEAST_HALF)
    ground = ABOVE + UNITS_PER_M * tallest_m
    child = bundle.manifest.child
    sex = f"{SEXES[child.sex]}, " if child.sex else ""
    texts = f"{sex}{child.age_months:.3g} mo", words.quantity(child.length_cm, "cm")
    labels = [label((half, ground + 16 + 14 * row), text, "small middle") for row, text in enumerate(texts)]
    shapes = (*outline.shapes(UNITS_PER_M, (half, ground)), *labels)
    return Drawing(", ".join(texts), (2 * half, ground + BELOW), shapes, kind="body")
