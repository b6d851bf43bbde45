"""The measures of a cohort by factor: values of one column of its table over those of another, and their plots."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, takewhile
from math import isfinite

import numpy as np

from mimoc.base.quantities import Quantity, quantity_of
from mimoc.render.plots.drawing import around, ticks
from mimoc.render.plots.plot import Dots, Line, Plot, Ticks
from mimoc.studies.cohorts.table import Cell, Rows
from mimoc.studies.reporting import words

OF_CHILDREN = ("_percentile", "_percent", "_cm", "_kg", "maturation_rate")
"""How the names of factors end that children are given by."""
LEAST = 2  # Different values that a factor must have to be one.
MOST_LEVELS = 12
"""Values of a factor up to which each has a summary; of more, those of numbers are put together in bins."""
MOST_DOTS = 300  # Jobs up to which each is a dot if its factor has too many values.
MOST_LETTERS = 14
BETWEEN = 0.5  # Room at either end of an axis of names, in distances of two.
LEVELS = {True: "true", False: "false", None: "none"}


@dataclass(frozen=True, slots=True)
class Measure:
    """A measure of the jobs of a step."""

    quantity: Quantity
    step: str  # Empty for a measure of the body, which all steps share.
    rows: Rows  # The rows that have it.
    values: tuple[float, ...]  # Of each of these rows.

    @property
    def title(self) -> str:
        """What it is called, with its unit and its step."""
        return f"{self.quantity.title}, {self.step}" if self.step else self.quantity.title

    @property
    def is_share(self) -> bool:
        """Whether it says yes or no, as 1 and 0."""
        return all(isinstance(row[self.quantity.name], bool) for row in self.rows)

    @property
    def is_constant(self) -> bool:
        """Whether it is the same for all."""
        return len(set(self.values)) < LEAST

    def factors(self, names: Sequence[str]) -> list[str]:
        """Return the factors that differ between its rows."""
        return [name for name in names if name != "child" and len({row[name] for row in self.rows} - {None}) >= LEAST]

    def plot(self, factor: str) -> Plot | None:
        """Return its plot by a factor; None if too many of the factor's values are not numbers."""
        points = [
            (row[factor], value) for row, value in zip(self.rows, self.values, strict=True) if row[factor] is not None
        ]
        groups: dict[Cell, list[float]] = {}
        for level, value in points:
            groups.setdefault(level, []).append(value)
        if all(_number(level) is not None and not isinstance(level, bool) for level in groups):
            numbers = [(float(level or 0), value) for level, value in points]
            if len(groups) > MOST_LEVELS or factor.endswith(OF_CHILDREN):
                return self._scattered(numbers, factor)
            return self._summaries({float(level or 0): values for level, values in groups.items()}, None, factor)
        if len(groups) > MOST_LEVELS:
            return None
        ordered = sorted(groups, key=str)
        texts = [LEVELS.get(level, str(level)) for level in ordered]
        short = [text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 1]}…" for text in texts]
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
        if len(points) <= MOST_DOTS and not self.is_share:
            dots = Dots([x for x, _ in points], [y for _, y in points], "", "one")
            return replace(self._by(factor), dots=(dots,))
        low, high = min(x for x, _ in points), max(x for x, _ in points)
        width = (high - low) / MOST_LEVELS
        groups: dict[float, list[float]] = {}
        for x, value in points:
            number = min(int((x - low) / width), MOST_LEVELS - 1)
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
    seen: dict[tuple[Cell, ...], Mapping[str, Cell]] = {}
    for row in rows:
        factors = takewhile(lambda name: name != "step", row)
        seen.setdefault(tuple(row[name] for name in factors if name != "job"), row)
    return list(seen.values())


def _number(cell: Cell) -> float | None:
    return float(cell) if isinstance(cell, (bool, int, float)) and isfinite(cell) else None


def _at(places: Sequence[float]) -> Ticks:
    """Return ticks at the places themselves, if they are few, or at round numbers."""
    near = (places[-1] - places[0]) / 12
    if len(places) <= 8 and all(after - before > near for before, after in pairwise(places)):
        return [(place, f"{place:.4g}") for place in places]
    return ticks(places[0], places[-1])
