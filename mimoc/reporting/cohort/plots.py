"""Plots of a cohort: each measure by each factor."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from mimoc.quantities import quantity_of
from mimoc.render.plots.plot import Dots, Line, Plot, Ticks
from mimoc.render.plots.svg import around, ticks
from mimoc.reporting import words
from mimoc.reporting.cohort.measures import OF_CHILDREN, Measure, is_number

MOST_LEVELS = 12
"""Values of a factor up to which each has a summary; of more, those of numbers are put together in bins."""
MOST_DOTS = 300
"""Jobs up to which each is a dot if its factor has too many values."""
MOST_LETTERS = 14
BETWEEN = 0.5
"""Room at either end of an axis of names, in distances of two."""
COLUMN = {True: "true", False: "false", None: "none"}


def plot(measure: Measure, factor: str, about: str) -> Plot | None:
    """Return the plot of a measure by a factor; None if too many of the factor's values are not numbers.

    Args:
        measure: What is drawn upwards.
        factor: The column that is drawn to the right.
        about: What the measure is, as a title.
    """
    pairs = [(row[factor], value) for row, value in zip(measure.rows, measure.values, strict=True)]
    pairs = [(level, value) for level, value in pairs if level is not None]
    levels = list(dict.fromkeys(level for level, _ in pairs))
    if is_number(levels):
        points = [(float(level or 0), value) for level, value in pairs]
        if len(levels) > MOST_LEVELS or factor.endswith(OF_CHILDREN):
            return _scattered(points, measure, factor, about)
        places = {level: float(level or 0) for level in levels}
        return _summaries({places[level]: _values(pairs, level) for level in levels}, None, measure, factor, about)
    if len(levels) > MOST_LEVELS:
        return None
    ordered = sorted(levels, key=str)
    names = [(float(place), _short(COLUMN.get(level, str(level)))) for place, level in enumerate(ordered)]
    groups = {float(place): _values(pairs, level) for place, level in enumerate(ordered)}
    return _summaries(groups, names, measure, factor, about)


def _summaries(
    groups: Mapping[float, Sequence[float]], names: Ticks | None, measure: Measure, factor: str, about: str
) -> Plot:
    """Return a plot with median, quartiles and range of each group, by its place on the horizontal axis."""
    places = sorted(groups)
    lines: list[Line] = []
    middles: list[float] = []
    titles: list[str] = []
    for place in places:
        values = np.array(groups[place])
        low, first, middle, third, high = np.quantile(values, (0, 0.25, 0.5, 0.75, 1)).tolist()
        title = f"{len(values)}: median {words.figure(middle)}, {words.figure(low)} to {words.figure(high)}"
        if measure.is_share:
            middle = float(values.mean())
            title = f"{100 * middle:.0f} % of {len(values)}"
        else:
            lines += [Line((place, place), (low, high), "", "whisker")] if high > low else []
            lines += [Line((place, place), (first, third), "", "quartiles")] if third > first else []
        middles.append(middle)
        titles.append(title)
    if names is None and len(places) > 1:
        lines.insert(0, Line(places, middles))
    return replace(
        _over(measure, factor, about),
        lines=tuple(lines),
        dots=(Dots(places, middles, "", "mean", tuple(titles), 4.0),),
        x_range=(places[0] - BETWEEN, places[-1] + BETWEEN) if names else around(places),
        y_range=(0.0, 1.0) if measure.is_share else around(value for values in groups.values() for value in values),
        x_ticks=names if names is not None else _at(places),
    )


def _scattered(points: Sequence[tuple[float, float]], measure: Measure, factor: str, about: str) -> Plot:
    """Return a plot with a dot for each job, or with bins if there are too many."""
    if len(points) > MOST_DOTS or measure.is_share:
        return _binned(points, measure, factor, about)
    dots = Dots([x for x, _ in points], [y for _, y in points], "", "one")
    return replace(_over(measure, factor, about), dots=(dots,))


def _binned(points: Sequence[tuple[float, float]], measure: Measure, factor: str, about: str) -> Plot:
    low, high = min(x for x, _ in points), max(x for x, _ in points)
    width = (high - low) / MOST_LEVELS
    groups: dict[float, list[float]] = {}
    for x, value in points:
        number = min(int((x - low) / width), MOST_LEVELS - 1)
        groups.setdefault(low + (number + 0.5) * width, []).append(value)
    return _summaries(groups, None, measure, factor, about)


def _over(measure: Measure, factor: str, about: str) -> Plot:
    """Return an empty plot of a measure by a factor."""
    description = f"{about} by {quantity_of(factor).heading}, {words.count(len(measure.values), 'job')}"
    return Plot(quantity_of(factor), quantity_of(measure.name), title=about, about=description)


def _values(pairs: Sequence[tuple[object, float]], level: object) -> list[float]:
    return [value for other, value in pairs if other == level]


def _at(places: Sequence[float]) -> Ticks:
    """Return ticks at the places themselves, if they are few, or at round numbers."""
    near = (places[-1] - places[0]) / 12
    if len(places) <= 8 and all(after - before > near for before, after in pairwise(places)):
        return [(place, f"{place:.4g}") for place in places]
    return ticks(places[0], places[-1])


def _short(text: str) -> str:
    return text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 1]}…"
