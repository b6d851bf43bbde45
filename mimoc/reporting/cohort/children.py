"""The children of a cohort: who they are, and how the infants look that were built."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.cohorts import Job
from mimoc.cohorts.store import Store
from mimoc.quantities import Quantity
from mimoc.quantities.child import HEAD, LENGTH, WEIGHT
from mimoc.render.plots.drawing import Drawing, draw_svg, label
from mimoc.render.plots.plot import Dots, Plot
from mimoc.reporting import words
from mimoc.reporting.page import Block, Cell, Details, Drawings, Section, TextBlock, number, table
from mimoc.reporting.silhouette import Silhouette, silhouette

MOST_DRAWN = 12
"""Infants that are drawn, evenly chosen from all."""
MOST_LISTED = 200
NOT_OF_BODIES = ("actuation.", "delays.", "noise.", "senses.", "scene.", "control.", "task.")
"""How keys of the spec begin that leave the body as it is."""
UNITS_PER_M = 240.0
BELOW, ABOVE = 36.0, 12.0
"""Room below the drawn infants and above."""
LEAST_HALF = 34.0
"""Half of the least width, so that there is room for the words below."""
KINDS = {"female": "girl", "male": "boy"}
LENGTHS = {
    "length_percentile": Quantity("length_percentile", "Length", "percentile", limits=(0.0, 100.0)),
    "length_cm": LENGTH,
}
AGAINST_LENGTH = {
    "weight_percentile": Quantity("weight_percentile", "Weight", "percentile", limits=(0.0, 100.0)),
    "weight_kg": WEIGHT,
    "head_percentile": Quantity("head_percentile", "Head", "percentile", limits=(0.0, 100.0)),
    "head_circumference_cm": HEAD,
}
"""Quantities by the keys of an individual; each of these is drawn against each of LENGTHS."""


def children(jobs: Sequence[Job], store: Store) -> Section | None:
    """Return the section on the children of a cohort, None if it has only one infant of which nothing is known."""
    known = _individuals(jobs)
    blocks: list[Block] = []
    if known:
        blocks += _scatters(known)
    blocks += _outlines(jobs, store)
    if known:
        blocks.append(_list(known))
    return Section("children", "The children", tuple(blocks)) if blocks else None


def _individuals(jobs: Sequence[Job]) -> dict[int, Mapping[str, Any]]:
    """Return what is known of each child, by its number; what differs between its ages is left out."""
    known: dict[int, dict[str, Any]] = {}
    for job in jobs:
        child = job.factors.get("child")
        if isinstance(child, int):
            factors = {name: value for name, value in job.factors.items() if "." not in name and name != "age_months"}
            before = known.setdefault(child, factors)
            known[child] = {name: value for name, value in before.items() if factors.get(name) == value}
    return dict(sorted(known.items()))


def _scatters(known: Mapping[int, Mapping[str, Any]]) -> list[Block]:
    """Return plots of measures against each other, where the children that have both differ."""
    plots = []
    for across, up in product(LENGTHS, AGAINST_LENGTH):
        pairs = [(child, child[across], child[up]) for child in known.values() if {across, up} <= child.keys()]
        if len({pair[1:] for pair in pairs}) > 1:
            plots.append(_scatter(pairs, across, up))
    caption = f"{words.count(len(known), 'child', 'children')} of the cohort; girls orange, boys blue."
    return [Drawings(tuple(plots), caption, "pair")] if plots else []


def _scatter(pairs: Sequence[tuple[Mapping[str, Any], float, float]], across: str, up: str) -> Drawing:
    length, other = LENGTHS[across], AGAINST_LENGTH[up]
    dots: list[Dots] = []
    for child, x, y in pairs:
        text = f"child {child['child']}: {_phrase(length)} {words.figure(x)}, {_phrase(other)} {words.figure(y)}"
        dots.append(Dots((x,), (y,), "", KINDS.get(child.get("sex", ""), "mean"), (text,), 4.0))
    title = f"{other.label} by {_phrase(length)}{other.title.removeprefix(other.label)}"
    about = f"{title} of {len(pairs)} children"
    return draw_svg(Plot(length, other, dots=tuple(dots), title=title, about=about))


def _phrase(quantity: Quantity) -> str:
    return quantity.label.lower()


def _list(known: Mapping[int, Mapping[str, Any]]) -> Block:
    names = [*dict.fromkeys(name for child in known.values() for name in child)]
    shown = list(known.values())[:MOST_LISTED]
    rows = [tuple(_cell(child.get(name)) for name in names) for child in shown]
    more = f", the first {MOST_LISTED} of them" if len(known) > MOST_LISTED else ""
    return Details(f"All {len(known)} children{more}", (table([words.name(name) for name in names], rows),))


def _cell(value: Any) -> Cell:
    if isinstance(value, float):
        return number(words.figure(value))
    return number(f"{value}") if isinstance(value, int) else Cell("" if value is None else str(value))


def _outlines(jobs: Sequence[Job], store: Store) -> Iterator[Block]:
    """Yield a drawing of the infants that were built, to scale."""
    built = [job for job in jobs if job.step == "build" and (result := store.read(job)) and result.ok]
    if not built:
        yield TextBlock("No infants are drawn, because the cohort has no step that builds them (do: [build]).", "note")
        return
    first = {_body(job): job for job in reversed(built)}
    bodies = sorted((job for job in built if first[_body(job)] is job), key=_months)
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
    """Yield the bundle of a job, unless it is gone or damaged."""
    try:
        yield store.read_bundle(job)
    except MimocError:
        return


def _outline(bundle: Bundle, outline: Silhouette, tallest_m: float) -> Drawing:
    """Return an infant with its age and its length, on the same ground as the tallest one."""
    half = max(UNITS_PER_M * outline.half_width_m, LEAST_HALF)
    ground = ABOVE + UNITS_PER_M * tallest_m
    child = bundle.manifest.child
    sex = {"male": "boy, ", "female": "girl, "}.get(child.sex or "", "")
    texts = f"{sex}{child.age_months:.3g} mo", words.quantity(child.length_cm, "cm")
    labels = [label((half, ground + 16 + 14 * row), text, "small middle") for row, text in enumerate(texts)]
    shapes = (*outline.shapes(UNITS_PER_M, (half, ground)), *labels)
    return Drawing(", ".join(texts), (2 * half, ground + BELOW), shapes, kind="body")
