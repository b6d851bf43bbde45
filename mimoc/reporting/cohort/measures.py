"""The measures of a cohort by factor: values of one column of its table for each value of another."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from mimoc.cohorts.table import Cell, Rows
from mimoc.quantities import quantity_of

OF_CHILDREN = ("_percentile", "_cm", "_kg")
"""How the names of factors end that children are given by."""
NOT_FACTORS = ("child",)
LEAST = 2
"""Different values that a factor must have to be one."""


@dataclass(frozen=True, slots=True)
class Measure:
    """A measure of the jobs of a step."""

    name: str
    step: str
    """Empty for a measure of the body, which all steps share."""
    rows: Rows
    """The rows that have it."""
    values: tuple[float, ...]
    """Of each of these rows."""
    is_share: bool
    """Whether it says yes or no, as 1 and 0."""

    @property
    def is_constant(self) -> bool:
        """Whether it is the same for all."""
        return len(set(self.values)) < LEAST


def measures_of(rows: Rows, names: Sequence[str]) -> tuple[Measure, ...]:
    """Return all measures that are numbers, or yes and no, in the order of *names*; by step, but those of the body."""
    known: list[Measure] = []
    steps = [*dict.fromkeys(str(row["step"]) for row in rows)]
    for name in names:
        if quantity_of(name).over == "child":
            known += _measure(name, "", _once_an_infant(row for row in rows if _number(row[name]) is not None))
        else:
            for step in steps:
                known += _measure(name, step, [row for row in rows if row["step"] == step])
    return tuple(known)


def factors_of(rows: Rows, names: Sequence[str]) -> tuple[str, ...]:
    """Return the factors that differ between some rows."""
    return tuple(
        name for name in names if name not in NOT_FACTORS and len({row[name] for row in rows} - {None}) >= LEAST
    )


def title_of(measure: Measure) -> str:
    """Return what a measure is called, with its unit and its step."""
    title = quantity_of(measure.name).title
    return f"{title}, {measure.step}" if measure.step else title


def is_number(values: Sequence[Cell]) -> bool:
    """Return whether all values are numbers."""
    return all(_number(value) is not None and not isinstance(value, bool) for value in values)


def _measure(name: str, step: str, rows: Rows) -> Iterator[Measure]:
    """Yield a measure, unless no row has a number of it."""
    pairs = [(row, number) for row in rows if (number := _number(row[name])) is not None]
    if pairs:
        kept = [row for row, _ in pairs]
        is_share = all(isinstance(row[name], bool) for row in kept)
        yield Measure(name, step, kept, tuple(number for _, number in pairs), is_share)


def _once_an_infant(rows: Iterator[Mapping[str, Cell]]) -> Rows:
    """Return the first row of each infant, which its factors tell from the others."""
    seen: dict[tuple[Cell, ...], Mapping[str, Cell]] = {}
    for row in rows:
        before = [*row][: [*row].index("step")]
        seen.setdefault(tuple(row[name] for name in before if name != "job"), row)
    return list(seen.values())


def _number(cell: Cell) -> float | None:
    if isinstance(cell, (bool, int, float)) and isfinite(cell):
        return float(cell)
    return None
