"""Sessions of two infants whose phases follow each other: when phases end, kicks a minute, and what is compared."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.runtime.sense import FloatArray
from mimoc.studies.experiments.legs.intervals import interval, sign_test
from mimoc.studies.experiments.legs.trials import Result


@dataclass(frozen=True, slots=True)
class Phases:
    """The phases of a session."""

    lengths_s: tuple[float, ...]
    longest_s: float  # Most of the end of a phase by which it is judged.

    @property
    def ends_s(self) -> tuple[float, ...]:
        """When each phase ends."""
        return tuple(np.cumsum(self.lengths_s).tolist())

    @property
    def compared_s(self) -> float:
        """How much of the end of each phase is compared."""
        return min(self.longest_s, *self.lengths_s)

    def counts(self, times_s: FloatArray) -> list[int]:
        """Return how many of some times, shape (n,), are within the end of each phase that is compared."""
        return [int(((times_s >= end_s - self.compared_s) & (times_s < end_s)).sum()) for end_s in self.ends_s]


def rates_per_min(times_s: FloatArray, seconds: float, bin_s: float) -> tuple[float, ...]:
    """Return how many of some times, shape (n,), there are a minute in each bin of a session."""
    counts, _ = np.histogram(times_s, np.arange(round(seconds / bin_s) + 1) * bin_s)
    return tuple((60.0 * counts / bin_s).tolist())


def values_of(results: Sequence[Result], name: str) -> list[float]:
    """Return a measure of all trials."""
    return [result.values[name] for result in results]


def differences(results: Sequence[Result], larger: str, smaller: str) -> list[float]:
    """Return by how much one measure exceeds another in each trial."""
    return [a - b for a, b in zip(values_of(results, larger), values_of(results, smaller), strict=True)]


def direction_rows(asked: Mapping[str, Sequence[float]]) -> Iterator[tuple[str, ...]]:
    """Yield a row of a table for each prediction: its mean difference, in how many trials it holds, and its p."""
    for name, values in asked.items():
        holds = f"{sum(value > 0 for value in values)} of {len(values)}"
        yield name, interval(values).text(), holds, f"{sign_test(values):.2g}"
