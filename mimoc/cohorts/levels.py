"""The values of a varied key: a list, a range, or draws."""

import math
from statistics import NormalDist
from typing import Any

import numpy as np

from mimoc.random_streams import between, stream
from mimoc.rounding import rounded
from mimoc.schema.cohort_file import DrawsSpec, RangeSpec


def levels_of(key: str, levels: Any) -> tuple[Any, ...]:
    """Return the values of a key: those of a list or a range, or as many draws as it says."""
    if isinstance(levels, RangeSpec):
        return _range(levels)
    if isinstance(levels, DrawsSpec):
        return draws(key, levels, levels.n or 1)
    return levels


def draws(key: str, levels: DrawsSpec, number: int) -> tuple[Any, ...]:
    """Return a number of values drawn from a distribution."""
    generator = stream(levels.seed, f"cohort.vary.{key}")
    return tuple(_whole(rounded(_draw(levels, generator))) for _ in range(number))


def _range(levels: RangeSpec) -> tuple[Any, ...]:
    steps = math.floor((levels.to - levels.start) / levels.step + 1e-9)
    return tuple(_whole(rounded(levels.start + index * levels.step)) for index in range(steps + 1))


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
