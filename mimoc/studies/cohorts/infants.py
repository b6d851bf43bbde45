"""The infants of a cohort: every combination of children and varied keys, as a spec each."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from statistics import NormalDist
from typing import Any

import numpy as np

from mimoc.base.errors import Problem, SpecError
from mimoc.base.random_streams import between, stream, whole_between
from mimoc.base.rounding import rounded
from mimoc.schema.base import KeyedError, changed, dotted, given, plain
from mimoc.schema.body import IndividualSpec
from mimoc.schema.cohort_file import CohortSpec, DrawnChildren, DrawsSpec, RangeSpec, SampleDesign
from mimoc.schema.infant import InfantSpec, at_another_age, read_spec
from mimoc.schema.quantities import MAX_PERCENTILE, MIN_PERCENTILE
from mimoc.schema.sizes import check_sizes
from mimoc.schema.source import Source, in_memory

MAX_INFANTS = 1_000_000  # Infants of one cohort: a million take 3 GB of memory.
Place = tuple[str | int, ...]  # Path in the cohort file of a value that was chosen.


@dataclass(frozen=True, slots=True)
class DesignRow:
    """One infant, as the cohort's design chooses it."""

    child: int | None  # Number of its child; None if the cohort has no children.
    values: tuple[tuple[str, Any, Place], ...]  # Value of each varied key, and where in the file it stands.


@dataclass(frozen=True, slots=True)
class CohortInfant:
    """One infant of a cohort."""

    factors: Mapping[str, Any]  # What tells it from the others: its child, and the value of each varied key.
    data: Mapping[str, Any]  # Its spec, as it would be written in a file.
    spec: InfantSpec


def children_of(cohort: CohortSpec) -> tuple[IndividualSpec, ...]:
    """Return the children of a cohort, none if it has only that of its base."""
    if isinstance(cohort.children, DrawnChildren):
        return draw_children(cohort.children)
    return cohort.children or ()


def infants_of(cohort: CohortSpec, source: Source, base: Source) -> tuple[CohortInfant, ...]:
    """Return all infants of a cohort, in the order of its design; a SpecError names combinations that are invalid."""
    _check_number(cohort, source)
    children, origin = children_of(cohort), read_spec(base)
    _check_children(cohort, source, origin)
    infants, problems = [], []
    for choice in _choices(cohort, len(children)):
        child = None if choice.child is None else children[choice.child]
        data = _data(base.data, origin, choice, child)
        try:
            spec = read_spec(in_memory(data, base.file, base.folder))
        except SpecError as error:
            problems += [_traced(problem, choice, source) for problem in error.problems]
        else:
            of_child = {} if child is None else {"child": choice.child, **given(child)}
            factors = {**of_child, **{key: value for key, value, _ in choice.values}}
            infants.append(CohortInfant(factors, data, spec))
    if problems:
        raise SpecError(problems)
    return tuple(infants)


def _check_children(cohort: CohortSpec, source: Source, origin: InfantSpec) -> None:
    """Raise a SpecError if a listed child, together with the base, gives two values of one size."""
    problems = []
    for index, child in enumerate(cohort.children if isinstance(cohort.children, tuple) else ()):
        try:
            check_sizes(origin.body.model_copy(update={"individual": child}), origin.age_months)
        except KeyedError as error:
            is_own = error.key[:2] == ("body", "individual")
            place = ("children", index, *(error.key[2:] if is_own else ()))
            problems.append(
                source.problem(place, str(error) if is_own else f"with the base's {dotted(error.key)}: {error}")
            )
    if problems:
        raise SpecError(problems)


def _check_number(cohort: CohortSpec, source: Source) -> None:
    """Raise a SpecError if parallel lists differ in length, or if there are too many infants, before any is made."""
    lengths = {key: len(levels_of(key, levels)) for key, levels in cohort.vary.items()}
    in_parallel = cohort.design == "zip"
    if in_parallel and len({*lengths.values()}) > 1:
        listed = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise SpecError([source.problem(("design",), f"'zip' requires equally many values of each key, got {listed}")])
    children = cohort.children.draw if isinstance(cohort.children, DrawnChildren) else len(cohort.children or (None,))
    number = children * (max(lengths.values(), default=1) if in_parallel else prod(lengths.values()))
    if number > MAX_INFANTS and not isinstance(cohort.design, SampleDesign):
        advice = "give fewer values, a sample, or several cohort files"
        raise SpecError([source.problem((), f"{number:,} infants are more than {MAX_INFANTS:,}; {advice}")])


def _choices(cohort: CohortSpec, children: int) -> Iterator[DesignRow]:
    numbers: Sequence[int | None] = range(children) if children else (None,)
    if isinstance(cohort.design, SampleDesign):
        yield from _sampled(cohort, cohort.design, numbers)
        return
    columns = [_column(key, levels_of(key, levels)) for key, levels in cohort.vary.items()]
    rows = [*(zip(*columns, strict=True) if cohort.design == "zip" and columns else product(*columns))]
    yield from (DesignRow(number, row) for number in numbers for row in rows)


def _sampled(cohort: CohortSpec, design: SampleDesign, numbers: Sequence[int | None]) -> Iterator[DesignRow]:
    size, columns = design.sample, []
    for key, levels in cohort.vary.items():
        if isinstance(levels, DrawsSpec):
            columns.append([(key, value, ("vary", key)) for value in draws(key, levels, size.n)])
        else:
            known = _column(key, levels_of(key, levels))
            generator = stream(size.seed, f"cohort.sample.{key}")
            columns.append([known[whole_between(generator, 0, len(known) - 1)] for _ in range(size.n)])
    generator = stream(size.seed, "cohort.sample.child")
    for index in range(size.n):
        number = numbers[whole_between(generator, 0, len(numbers) - 1)]
        yield DesignRow(number, tuple(column[index] for column in columns))


def _column(key: str, levels: Sequence[Any]) -> list[tuple[str, Any, Place]]:
    return [(key, value, ("vary", key, index)) for index, value in enumerate(levels)]


def _data(
    base: Mapping[str, Any], origin: InfantSpec, choice: DesignRow, child: IndividualSpec | None
) -> dict[str, Any]:
    """Return the spec of an infant: the base as it is at the chosen age, the varied keys, and its child.

    What base and children say in cm and kg is of the base's age; varied values are of the infant's own.
    """
    body = origin.body if child is None else origin.body.model_copy(update={"individual": child})
    age = next((value for key, value, _ in choice.values if key == "age_months"), origin.age_months)
    grown = at_another_age(body, origin.age_months, plain(age), origin.months_early)
    data = changed(base, {"body": grown}) if grown else dict(base)
    for key, value, _ in choice.values:
        data = _with(data, key.split("."), value)
    if child is None:
        return data
    return _with(data, ["body", "individual"], changed(given(child), grown.get("individual", {})))


def _with(data: Mapping[str, Any], keys: Sequence[str], value: Any) -> dict[str, Any]:
    """Return data in which one key has another value; None removes it. A value in the way of the key stays."""
    first, *deeper = keys
    if deeper:
        below = data.get(first, {})
        value = _with(below, deeper, value) if isinstance(below, Mapping) else below
    rest = {key: item for key, item in data.items() if key != first}
    return rest if value is None else {**rest, first: value}


def _traced(problem: Problem, choice: DesignRow, source: Source) -> Problem:
    """Return the problem of an infant's spec as one of the value in the cohort file that it comes from."""
    for key, _, place in choice.values:
        if f"{problem.key}.".startswith(f"{key}.") or f"{key}.".startswith(f"{problem.key}."):
            deeper = problem.key.removeprefix(key).lstrip(".") if problem.key.startswith(key) else problem.key
            return source.problem(place, f"{deeper}: {problem.message}" if deeper else problem.message)
    values = ", ".join(f"{key}: {value}" for key, value, _ in choice.values)
    return source.problem(("vary",), f"with {values}: {problem.key}: {problem.message}")


def levels_of(key: str, levels: Any) -> tuple[Any, ...]:
    """Return the values of a key: those of a list or a range, or as many draws as it says."""
    if isinstance(levels, RangeSpec):
        steps = math.floor((levels.to - levels.start) / levels.step + 1e-9)
        return tuple(_whole(rounded(levels.start + index * levels.step)) for index in range(steps + 1))
    if isinstance(levels, DrawsSpec):
        return draws(key, levels, levels.n or 1)
    return levels


def draws(key: str, levels: DrawsSpec, number: int) -> tuple[Any, ...]:
    """Return a number of values drawn from a distribution."""
    generator = stream(levels.seed, f"cohort.vary.{key}")
    return tuple(_whole(rounded(_draw(levels, generator))) for _ in range(number))


def _draw(levels: DrawsSpec, generator: np.random.Generator) -> float:
    if levels.uniform:
        value = between(generator, *levels.uniform)
    elif levels.log_uniform:
        value = math.exp(between(generator, *map(math.log, levels.log_uniform)))
    else:
        mean, deviation = levels.normal or (0.0, 1.0)
        value = mean + deviation * NormalDist().inv_cdf(between(generator, 1e-9, 1 - 1e-9))
    return round(value / levels.step) * levels.step if levels.step else value


def _whole(value: float) -> float | int:
    """Return a whole number as an integer, since some keys take no others."""
    return int(value) if value.is_integer() else value


PERCENTILES = ("length_percentile", "weight_percentile", "head_percentile")

LENGTH_WEIGHT = 0.74
"""Correlation of the z-scores of length and weight.

Derived for mimoc (D) from WHO's own standards: log BMI is log weight minus twice log length, so that their coefficients
of variation give r = (S_weight^2 + 4 S_length^2 - S_bmi^2) / (4 S_weight S_length). At 24 months, where S_bmi is .07771
for boys and .08545 for girls (last day of WHO's tables of BMI for age from birth to two years, read in a copy), that is
.75 and .74. Its change with age is left out.
"""
LENGTH_HEAD, WEIGHT_HEAD = 0.45, 0.5
"""Correlations of the z-score of head circumference with those of length and weight: an assumption (M), not a source's.

Geraedts et al. 2011 (Horm Res Paediatr 75:213-219; 14,500 Dutch children) find that the head correlates with both, most
at birth and, after a rapid decline, at a stable level. Only their abstract was at hand, which gives no numbers.
"""
CORRELATIONS = np.array(  # Correlations of the z-scores of length, weight and head, shape (3, 3).
    [[1, LENGTH_WEIGHT, LENGTH_HEAD], [LENGTH_WEIGHT, 1, WEIGHT_HEAD], [LENGTH_HEAD, WEIGHT_HEAD, 1]]
)

FAT_BUILD = 0.6
"""Correlation of the z-scores of fat and of weight for length: between .51 of weight for length and .73 of BMI, which
Roy et al. 2019 (J Pediatr; 293 infants of one month, S) find with fat over length squared (D). Fat depends on length
and head in no other way: an assumption.
"""
RATE_SD = 0.18
"""Standard deviation of the logarithm of the rate of maturation, which is correlated with nothing (D): fitted to WHO's
standard deviation of the age of sitting, 1.1 months, with what size and fat add to it."""

_FURTHEST = 1e-9  # Smallest probability of a tail that is drawn from, so that no draw is infinite.


def draw_children(wanted: DrawnChildren) -> tuple[IndividualSpec, ...]:
    """Return children whose percentiles are those of WHO's healthy children, and stay the same as they age.

    Each child has random numbers of its own: the first children of a seed are the same however many are drawn.
    """
    sexes = ("female", "male") if wanted.sex == "both" else (wanted.sex,)
    return tuple(
        IndividualSpec(
            sex=sexes[index % len(sexes)], **_drawn(stream(wanted.seed, f"cohort.child.{index}"), wanted.sizes_only)
        )
        for index in range(wanted.draw)
    )


def _drawn(generator: np.random.Generator, sizes_only: bool) -> dict[str, float]:
    """Return the percentiles of a child and its rate of maturation, which are drawn after its size.

    The mean of 1 / rate is 1, so that the mean age of a milestone stays.
    """
    shares = generator.random(len(PERCENTILES) + 2)
    normal = [NormalDist().inv_cdf(min(max(float(share), _FURTHEST), 1 - _FURTHEST)) for share in shares]
    length, weight, head = (float(z) for z in np.linalg.cholesky(CORRELATIONS) @ normal[: len(PERCENTILES)])
    percentiles = {name: _percentile(z) for name, z in zip(PERCENTILES, (length, weight, head), strict=True)}
    if sizes_only:
        return percentiles
    fat = FAT_BUILD * build_z(length, weight) + math.sqrt(1 - FAT_BUILD**2) * normal[-2]
    rate = math.exp(RATE_SD * normal[-1] + RATE_SD**2 / 2)
    return {**percentiles, "fat_percentile": _percentile(fat), "maturation_rate": rounded(min(max(rate, 0.5), 2.0))}


def build_z(length_z: float, weight_z: float) -> float:
    """Return how many standard deviations a child is heavier than others of its length and age."""
    return (weight_z - LENGTH_WEIGHT * length_z) / math.sqrt(1 - LENGTH_WEIGHT**2)


def _percentile(z: float) -> float:
    return rounded(min(max(100 * NormalDist().cdf(z), MIN_PERCENTILE), MAX_PERCENTILE))
