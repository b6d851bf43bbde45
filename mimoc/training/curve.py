"""Learning curves: how well an infant does, by the steps it has been trained for."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from mimoc.errors import TrainingError


@dataclass(frozen=True, slots=True)
class Finished:
    """An episode that came to its end while the infant was learning."""

    total_reward: float
    steps: int
    """Control steps."""
    success: bool


@dataclass(frozen=True, slots=True)
class Row:
    """What happened in the episodes that ended since the row before; means of none are NaN.

    An episode that a checkpoint cuts off counts nowhere, so that long ones count a little too seldom; `evaluate` does
    not have this fault.
    """

    steps: int
    """Control steps trained for so far, those of all infants together."""
    episodes: int
    """That ended."""
    episode_return: float
    """Mean of the sum of an episode's rewards."""
    success_rate: float
    """Share of the episodes in which the goal was reached."""
    episode_steps: float
    """Mean number of control steps."""
    time_to_success_s: float
    """Mean over the episodes that reached the goal, in simulated time."""
    wall_s: float
    """Time that training took so far; the one number here that another run of the same training does not repeat."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A learning curve, row by row."""

    rows: tuple[Row, ...] = ()

    @property
    def steps(self) -> int:
        """Control steps trained for."""
        return self.rows[-1].steps if self.rows else 0

    def column(self, name: str) -> npt.NDArray[np.float64]:
        """Return one number of each row, shape (n,), by the name of a field of `Row`."""
        return np.array([getattr(row, name) for row in self.rows], float)

    def columns(self) -> dict[str, npt.NDArray[np.float64]]:
        """Return all numbers by name, each of shape (n,)."""
        return {each.name: self.column(each.name) for each in fields(Row)}

    def to_csv(self) -> str:
        """Return it as CSV, no digit lost; what is not known is empty."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(each.name for each in fields(Row))
        writer.writerows(["" if math.isnan(value) else repr(value) for value in astuple(row)] for row in self.rows)
        return text.getvalue()

    @classmethod
    def from_csv(cls, text: str) -> Self:
        """Return what `to_csv` wrote.

        Raises:
            TrainingError: If it is something else.
        """
        try:
            return cls(tuple(map(_row, csv.DictReader(io.StringIO(text)))))
        except (KeyError, ValueError, TypeError):
            raise TrainingError("this is no learning curve; give the curve.csv of a training") from None


def sum_up(episodes: Sequence[Finished], steps: int, step_s: float, wall_s: float) -> Row:
    """Return the row of some episodes.

    Args:
        episodes: Those that ended since the row before.
        steps: Control steps trained for so far.
        step_s: A control step.
        wall_s: Time that training took so far.
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


def _row(cells: dict[str, str]) -> Row:
    numbers = {each.name: float(cells[each.name] or "nan") for each in fields(Row)}
    counts = {name: int(cells[name]) for name in ("steps", "episodes")}
    found: dict[str, Any] = {**numbers, **counts}
    return Row(**found)
