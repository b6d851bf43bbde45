"""Learning curves: performance as a function of the number of training steps."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from mimoc.errors import TrainingError
from mimoc.schema.bounded import bounded


@dataclass(frozen=True, slots=True)
class FinishedEpisode:
    """An episode that ended during training."""

    total_reward: float
    steps: int
    """Control steps."""
    success: bool


@dataclass(frozen=True, slots=True)
class Row:
    """Statistics of the episodes that ended since the previous row; the mean of no episodes is NaN.

    Episodes that a checkpoint interrupts are not counted, so that long episodes are slightly underrepresented;
    `evaluate` does not have this bias.
    """

    steps: int
    """Control steps trained for so far, summed over all environments."""
    episodes: int
    """Number of episodes that ended."""
    episode_return: float
    """Mean return per episode."""
    success_rate: float
    """Fraction of episodes that were successful."""
    episode_steps: float
    """Mean number of control steps per episode."""
    time_to_success_s: float
    """Mean simulated time to success, over the successful episodes."""
    wall_s: float
    """Wall time of the training so far; the only value here that is not reproducible."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A learning curve."""

    rows: tuple[Row, ...] = ()

    @property
    def steps(self) -> int:
        """Control steps trained for."""
        return self.rows[-1].steps if self.rows else 0

    def column(self, name: str) -> npt.NDArray[np.float64]:
        """Return one field of `Row`, by name, for all rows, shape (n,)."""
        return np.array([getattr(row, name) for row in self.rows], float)

    def columns(self) -> dict[str, npt.NDArray[np.float64]]:
        """Return all fields by name, each of shape (n,)."""
        return {each.name: self.column(each.name) for each in fields(Row)}

    def to_csv(self) -> str:
        """Return the curve as CSV in full precision; NaN is an empty cell."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(each.name for each in fields(Row))
        writer.writerows(["" if math.isnan(value) else repr(value) for value in astuple(row)] for row in self.rows)
        return text.getvalue()

    @classmethod
    def from_csv(cls, text: str) -> Self:
        """Return the curve that `to_csv` wrote.

        Raises:
            TrainingError: If the text is not a learning curve.
        """
        try:
            return cls(tuple(_possible(_row(cells)) for cells in csv.DictReader(io.StringIO(text))))
        except (KeyError, ValueError, TypeError, csv.Error):
            raise TrainingError("not a learning curve; give the curve.csv of a training run") from None


def summarize(episodes: Sequence[FinishedEpisode], steps: int, step_s: float, wall_s: float) -> Row:
    """Return the row of a learning curve for the given episodes.

    Args:
        episodes: Episodes that ended since the previous row.
        steps: Control steps trained for so far.
        step_s: Duration of a control step.
        wall_s: Wall time of the training so far.
    """
    return Row(
        steps=steps,
        episodes=len(episodes),
        episode_return=_mean(each.total_reward for each in episodes),
        success_rate=_mean(each.success for each in episodes),
        episode_steps=_mean(each.steps for each in episodes),
        time_to_success_s=_mean(each.steps * step_s for each in episodes if each.success),
        wall_s=wall_s,
    )


def _mean(values: Iterable[float]) -> float:
    found = list(values)
    return math.fsum(found) / len(found) if found else math.nan


def _possible(row: Row) -> Row:
    """Return a row, if its counts are none below zero or of more than 64 bits, and no mean is infinite."""
    for value in astuple(row):
        if (isinstance(value, int) and bounded(value) < 0) or math.isinf(value):
            raise ValueError(f"{value} is a number that no training has")
    return row


def _row(cells: dict[str, str]) -> Row:
    numbers = {each.name: float(cells[each.name] or "nan") for each in fields(Row)}
    counts = {name: int(cells[name]) for name in ("steps", "episodes")}
    found: dict[str, Any] = {**numbers, **counts}
    return Row(**found)
