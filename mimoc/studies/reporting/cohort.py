"""The page of a cohort: its jobs, its children, the infants that were built, and its measures by factor."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product, takewhile
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import MimocError
from mimoc.base.quantities import HEAD, LENGTH, WEIGHT, Quantity, quantity_of
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.render.drawing import Drawing, around, draw_svg, label, ticks
from mimoc.render.plots import Dots, Line, Plot, Ticks
from mimoc.studies.cohorts.cohort import Cohort, Failure, Status, status_of
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.store import Store, finished_jobs
from mimoc.studies.cohorts.table import Cell as TableCell, Rows, rows_of
from mimoc.studies.jobs import Progress
from mimoc.studies.reporting import words
from mimoc.studies.reporting.body import Silhouette, silhouette
from mimoc.studies.reporting.page import Block, Cell, Details, Drawings, Page, Section, TextBlock, number, table

MAX_FACTORS = 6  # Factors that each measure is drawn by.
MAX_PLOTS = 80
MAX_ERRORS = 20  # Different errors that are listed.
VERSION = "version."
UNKNOWN = (
    "Jobs that have not been done cannot be told from the folder alone. Name the cohort's file as well, with --cohort, "
    "and they are counted as missing."
)
CAPTION = (
    "Dots are medians, thick lines reach from the first to the third quartile, thin ones over the whole range; of what "
    "is true or false, dots are shares. With many different values of a number, each job is a dot."
)


def cohort_page(folder: Path, cohort: Cohort | None, progress: Progress) -> Page:
    """Return the page of a cohort; without the *cohort* itself, jobs that are not done yet are not known."""
    store = Store(folder)
    if cohort:
        store.check()
        jobs, damaged, shown = cohort.jobs(), (), cohort.spec.measure
    else:
        (jobs, damaged), shown = finished_jobs(store), ()
    status = status_of(jobs, store)
    rows = rows_of(jobs, store, shown, progress)
    sections = [_jobs(status, damaged, is_whole=cohort is not None), children(jobs, store)]
    sections += [_results(rows), _versions(rows)]
    infants = len({str(sorted(job.factors.items(), key=str)) for job in jobs})
    summary = f"{words.count(infants, 'infant')}, {words.count(status.jobs, 'job')}: "
    states = (("ok", "done"), ("failed", "failed"), ("missing", "not done yet"))
    summary += words.listed([f"{count:,} {name}" for state, name in states if (count := status.number(state))])
    return Page(
        kind="A cohort of mimoc",
        title=words.sentence(words.name(jobs[0].cohort if jobs else folder.name)),
        lead=(f"{summary}.",),
        sections=tuple(section for section in sections if section),
    )


def _jobs(status: Status, damaged: Sequence[str], *, is_whole: bool) -> Section:
    states = ("ok", "failed", "missing")[: 3 if is_whole else 2]
    rows = [
        (Cell(step), *(number(f"{counts.get(state, 0):,}") for state in states))
        for step, counts in status.counts.items()
    ]
    rows.append((Cell("All"), *(number(f"{status.number(state):,}") for state in states)))
    blocks: list[Block] = [table(("step", *states), rows)]
    if not is_whole:
        blocks.append(TextBlock(UNKNOWN, "note"))
    if damaged:
        names = ", ".join(damaged[:3])
        blocks.append(TextBlock(f"{words.count(len(damaged), 'result')} cannot be read, such as {names}.", "warning"))
    return Section("jobs", "What was done", (*blocks, *_failures(status)))


def _failures(status: Status) -> Iterator[Block]:
    """Yield a table of the errors, the most frequent first, each with an infant and a log to look at."""
    errors: dict[tuple[str, str], list[Failure]] = {}
    for failure in status.failures:
        errors.setdefault((failure.job.step, failure.error), []).append(failure)
    if not errors:
        return
    rows = []
    for (step, error), alike in sorted(errors.items(), key=lambda item: (-len(item[1]), item[0]))[:MAX_ERRORS]:
        first = alike[0]
        who = ", ".join(f"{name} {value}" for name, value in first.job.factors.items())
        log = "/".join(first.log.parts[-3:])
        rows.append((Cell(step), number(f"{len(alike):,}"), Cell(error, "bad"), Cell(who), Cell(log, "code")))
    yield TextBlock(f"{words.count(len(status.failures), 'job')} failed:")
    yield table(("step", "jobs", "error", "the first of these infants", "its log"), rows)
    if len(errors) > MAX_ERRORS:
        yield TextBlock(
            f"{len(errors) - MAX_ERRORS} more errors are in the table that 'mimoc cohort table' writes.", "note"
        )


def _results(rows: Rows) -> Section:
    names = [*rows[0]] if rows else ["seed", "status"]
    factors = [name for name in names[1 : names.index("seed")] if name != "step"]
    factors.sort(key=lambda name: (name == "sex" or name.endswith(OF_CHILDREN), name != "sex"))  # What is varied first.
    after = names[names.index("status") + 1 :]
    columns = [name for name in after if not name.startswith(VERSION) and name not in ("error", "log")]
    drawn, constant, left_out = [], [], dict[str, None]()
    for measure in measures_of([row for row in rows if row["status"] == "ok"], columns):
        if measure.is_constant:
            constant.append(f"{measure.title}: {words.figure(measure.values[0])}")
            continue
        varied = measure.factors(factors)
        left_out |= dict.fromkeys(varied[MAX_FACTORS:])
        drawn += [draw_svg(plot) for factor in varied[:MAX_FACTORS] if (plot := measure.plot(factor))]
    notes = [] if drawn else ["No measure differs between the jobs, or nothing varies that it could be drawn by."]
    if len(drawn) > MAX_PLOTS:
        notes.append(f"{len(drawn) - MAX_PLOTS} more plots are left out.")
    if left_out:
        headings = words.listed([quantity_of(name).heading for name in left_out])
        notes.append(f"Each measure is drawn by at most {MAX_FACTORS} factors; these are left out: {headings}.")
    if constant:
        notes.append(f"The same for all jobs that have it: {'; '.join(constant)}.")
    plots = (Drawings(tuple(drawn[:MAX_PLOTS]), CAPTION),) if drawn else ()
    return Section("results", "Results", (*plots, *(TextBlock(note, "note") for note in notes)))


def _versions(rows: Rows) -> Section:
    names = [name for name in (rows[0] if rows else ()) if name.startswith(VERSION)]
    versions = [
        (Cell(name.removeprefix(VERSION)), Cell(", ".join(sorted({str(row[name]) for row in rows if row[name]}))))
        for name in names
    ]
    return Section("versions", "Versions of the software", (table(("", ""), versions),))


OF_CHILDREN = ("_percentile", "_percent", "_cm", "_kg", "maturation_rate")
"""How the names of factors end that children are given by."""
MIN_LEVELS = 2  # Different values that a factor must have to be one.
MAX_LEVELS = 12
"""Values of a factor up to which each has a summary; of more, those of numbers are put together in bins."""
MAX_DOTS = 300  # Jobs up to which each is a dot if its factor has too many values.
MAX_LETTERS = 14
BETWEEN = 0.5  # Room at either end of an axis of names, in distances of two.
LEVELS = {True: "true", False: "false", None: "none"}


@dataclass(frozen=True, slots=True)
class Measure:
    """A measure of the jobs of a step."""

    quantity: Quantity
    step: str  # Empty for a measure of the body, which all steps share.
    rows: Rows  # The rows that have it.
    values: tuple[float, ...]  # Its value in each of these rows.

    @property
    def title(self) -> str:
        """Its name with its unit and its step."""
        return f"{self.quantity.title}, {self.step}" if self.step else self.quantity.title

    @property
    def is_share(self) -> bool:
        """Whether it says yes or no, as 1 and 0."""
        return all(isinstance(row[self.quantity.name], bool) for row in self.rows)

    @property
    def is_constant(self) -> bool:
        """Whether it is the same for all."""
        return len(set(self.values)) < MIN_LEVELS

    def factors(self, names: Sequence[str]) -> list[str]:
        """Return the factors that differ between its rows."""
        return [
            name for name in names if name != "child" and len({row[name] for row in self.rows} - {None}) >= MIN_LEVELS
        ]

    def plot(self, factor: str) -> Plot | None:
        """Return its plot by a factor; None if too many of the factor's values are not numbers."""
        points = [
            (row[factor], value) for row, value in zip(self.rows, self.values, strict=True) if row[factor] is not None
        ]
        groups: dict[TableCell, list[float]] = {}
        for level, value in points:
            groups.setdefault(level, []).append(value)
        if all(_number(level) is not None and not isinstance(level, bool) for level in groups):
            numbers = [(float(level or 0), value) for level, value in points]
            if len(groups) > MAX_LEVELS or factor.endswith(OF_CHILDREN):
                return self._scattered(numbers, factor)
            return self._summaries({float(level or 0): values for level, values in groups.items()}, None, factor)
        if len(groups) > MAX_LEVELS:
            return None
        ordered = sorted(groups, key=str)
        texts = [LEVELS.get(level, str(level)) for level in ordered]
        short = [text if len(text) <= MAX_LETTERS else f"{text[: MAX_LETTERS - 1]}…" for text in texts]
        names = [(float(place), text) for place, text in enumerate(short)]
        return self._summaries({float(place): groups[level] for place, level in enumerate(ordered)}, names, factor)

    def _summaries(self, groups: Mapping[float, Sequence[float]], names: Ticks | None, factor: str) -> Plot:
        """Return a plot with median, quartiles and range of each group, by its place on the horizontal axis."""
        places = sorted(groups)
        lines: list[Line] = []
        middles: list[float] = []
        titles: list[str] = []
        for place in places:
            values = np.array(groups[place])
            low, first, middle, third, high = np.quantile(values, (0, 0.25, 0.5, 0.75, 1)).tolist()
            title = f"{len(values)}: median {words.figure(middle)}, {words.figure(low)} to {words.figure(high)}"
            if self.is_share:
                middle = float(values.mean())
                title = f"{100 * middle:.0f} % of {len(values)}"
            else:
                ends = (low, high, "whisker"), (first, third, "quartiles")
                lines += [Line((place, place), (start, end), "", look) for start, end, look in ends if end > start]
            middles.append(middle)
            titles.append(title)
        if names is None and len(places) > 1:
            lines.insert(0, Line(places, middles))
        return replace(
            self._by(factor),
            lines=tuple(lines),
            dots=(Dots(places, middles, "", "mean", tuple(titles), 4.0),),
            x_range=(places[0] - BETWEEN, places[-1] + BETWEEN) if names else around(places),
            y_range=(0.0, 1.0) if self.is_share else around(value for values in groups.values() for value in values),
            x_ticks=names if names is not None else _at(places),
        )

    def _scattered(self, points: Sequence[tuple[float, float]], factor: str) -> Plot:
        """Return a plot with a dot for each job, or with the summaries of bins if there are too many."""
        if len(points) <= MAX_DOTS and not self.is_share:
            dots = Dots([x for x, _ in points], [y for _, y in points], "", "one")
            return replace(self._by(factor), dots=(dots,))
        low, high = min(x for x, _ in points), max(x for x, _ in points)
        width = (high - low) / MAX_LEVELS
        groups: dict[float, list[float]] = {}
        for x, value in points:
            number = min(int((x - low) / width), MAX_LEVELS - 1)
            groups.setdefault(low + (number + 0.5) * width, []).append(value)
        return self._summaries(groups, None, factor)

    def _by(self, factor: str) -> Plot:
        x = quantity_of(factor)
        about = f"{self.title} by {x.heading}, {words.count(len(self.values), 'job')}"
        return Plot(x, self.quantity, title=self.title, about=about)


def measures_of(rows: Rows, names: Sequence[str]) -> Iterator[Measure]:
    """Yield all measures that are numbers, or yes and no, in the order of *names*; by step, but those of the body."""
    steps = [*dict.fromkeys(str(row["step"]) for row in rows)]
    for quantity in map(quantity_of, names):
        known = [row for row in rows if _number(row[quantity.name]) is not None]
        for step in [""] if quantity.over == "child" else steps:
            chosen = [row for row in known if row["step"] == step] if step else _once_an_infant(known)
            if chosen:
                yield Measure(quantity, step, chosen, tuple(float(row[quantity.name] or 0) for row in chosen))


def _once_an_infant(rows: Rows) -> Rows:
    """Return the first row of each infant, which its factors tell from the others."""
    seen: dict[tuple[TableCell, ...], Mapping[str, TableCell]] = {}
    for row in rows:
        factors = takewhile(lambda name: name != "step", row)
        seen.setdefault(tuple(row[name] for name in factors if name != "job"), row)
    return list(seen.values())


def _number(cell: TableCell) -> float | None:
    return float(cell) if isinstance(cell, (bool, int, float)) and isfinite(cell) else None


def _at(places: Sequence[float]) -> Ticks:
    """Return ticks at the places themselves, if they are few, or at round numbers."""
    near = (places[-1] - places[0]) / 12
    if len(places) <= 8 and all(after - before > near for before, after in pairwise(places)):
        return [(place, f"{place:.4g}") for place in places]
    return ticks(places[0], places[-1])


MAX_DRAWN = 12  # Infants that are drawn, evenly chosen from all.
MAX_LISTED = 200
NOT_OF_BODIES = ("actuation.", "delays.", "noise.", "senses.", "scene.", "control.", "task.")
"""How keys of the spec begin that leave the body as it is."""
UNITS_PER_M = 240.0
BELOW, ABOVE = 36.0, 12.0  # Room below the drawn infants and above.
MIN_HALF = 34.0  # Half of the least width, so that there is room for the words below.
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
        rows = [[_cell(child.get(name)) for name in names] for child in list(known.values())[:MAX_LISTED]]
        more = f", the first {MAX_LISTED} of them" if len(known) > MAX_LISTED else ""
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
    number_drawn = min(len(bodies), MAX_DRAWN)
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
    half = max(UNITS_PER_M * outline.half_width_m, MIN_HALF)
    ground = ABOVE + UNITS_PER_M * tallest_m
    child = bundle.manifest.child
    sex = f"{SEXES[child.sex]}, " if child.sex else ""
    texts = f"{sex}{child.age_months:.3g} mo", words.quantity(child.length_cm, "cm")
    labels = [label((half, ground + 16 + 14 * row), text, "small middle") for row, text in enumerate(texts)]
    shapes = (*outline.shapes(UNITS_PER_M, (half, ground)), *labels)
    return Drawing(", ".join(texts), (2 * half, ground + BELOW), shapes, kind="body")
