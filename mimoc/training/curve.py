"""Learning curves: performance as a function of the number of training steps."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import MISSING, astuple, dataclass, fields
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import TrainingError
from mimoc.schema.quantities import bounded

if TYPE_CHECKING:  # Reading a curve must not load MuJoCo.
    from mimoc.runtime.quantities import EpisodeResult


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """Statistics of the episodes that ended since the previous row; the mean of no episodes is NaN.

    Episodes that a checkpoint interrupts are not counted among them, so that long episodes are slightly
    underrepresented; `evaluate` does not have this bias. They are unfinished episodes of the row at the checkpoint.
    """

    steps: int  # Control steps trained for so far, summed over all environments.
    episodes: int  # Number of episodes that ended.
    episode_return: float  # Mean return per episode.
    success_rate: float  # Fraction of episodes that were successful.
    episode_steps: float  # Mean number of control steps per episode.
    time_to_success_s: float  # Mean simulated time to success, over the successful episodes.
    wall_s: float  # Wall time of the training so far; the only value here that is not reproducible.
    unfinished: int = 0  # Number of episodes under way at the end of the row.
    unfinished_return: float = math.nan  # Their mean return so far: not comparable with that of whole episodes.
    unfinished_steps: float = math.nan  # Their mean number of control steps so far.


@dataclass(frozen=True, slots=True)
class DeviceUse:
    """What a training has taken of a device."""

    device: str
    control_steps_per_s: float  # Control steps of all infants together, learning included.
    physics_steps_per_s: float  # Likewise.
    memory_mb: float | None  # Most memory that PyTorch and Warp had on it; None on the CPU.
    overflowed: int  # Episodes that were cut because contacts or constraints of the infant did not fit.
    success: float  # Share of the infants that have success in an episode in which the trained policy explores nothing.


@dataclass(frozen=True, slots=True)
class Curve:
    """A learning curve.

    Example:
        >>> from pathlib import Path
        >>> from mimoc.training import Curve
        >>> Curve.from_csv(Path("runs/reach/curve.csv").read_text()).steps
        64
    """

    rows: tuple[CurvePoint, ...] = ()

    @property
    def steps(self) -> int:
        """Control steps trained for."""
        return self.rows[-1].steps if self.rows else 0

    @property
    def ends(self) -> tuple[CurvePoint, CurvePoint]:
        """The first and the last row with episodes that ended; of all rows, if none did. There must be a row."""
        rows = [row for row in self.rows if row.episodes] or self.rows
        return rows[0], rows[-1]

    def column(self, name: str) -> npt.NDArray[np.float64]:
        """Return one field of `CurvePoint`, by name, for all rows, shape (n,)."""
        return np.array([getattr(row, name) for row in self.rows], float)

    def columns(self) -> dict[str, npt.NDArray[np.float64]]:
        """Return all fields by name, each of shape (n,)."""
        return {column.name: self.column(column.name) for column in fields(CurvePoint)}

    def to_csv(self) -> str:
        """Return the curve as CSV in full precision; NaN is an empty cell."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(column.name for column in fields(CurvePoint))
        writer.writerows(["" if math.isnan(value) else repr(value) for value in astuple(row)] for row in self.rows)
        return text.getvalue()

    @classmethod
    def from_csv(cls, text: str) -> Self:
        """Return the curve that `to_csv` wrote.

        Raises:
            TrainingError: If the text is not a learning curve.
        """
        try:
            return cls(tuple(_row(cells) for cells in csv.DictReader(io.StringIO(text))))
        except (KeyError, ValueError, TypeError, csv.Error):
            raise TrainingError("not a learning curve; give the curve.csv of a training run") from None


def summarize(
    episodes: "Sequence[EpisodeResult]",
    steps: int,
    wall_s: float,
    unfinished: "Sequence[EpisodeResult]" = (),
) -> CurvePoint:
    """Return the row of a learning curve after so many control steps, for the episodes since the previous row.

    Of those that are *unfinished* at its end, results are so far.
    """
    return CurvePoint(
        steps=steps,
        episodes=len(episodes),
        episode_return=_mean(episode.total_reward for episode in episodes),
        success_rate=_mean(episode.success for episode in episodes),
        episode_steps=_mean(episode.steps for episode in episodes),
        time_to_success_s=_mean(episode.duration_s for episode in episodes if episode.success),
        wall_s=wall_s,
        unfinished=len(unfinished),
        unfinished_return=_mean(episode.total_reward for episode in unfinished),
        unfinished_steps=_mean(episode.steps for episode in unfinished),
    )


def _mean(values: Iterable[float]) -> float:
    numbers = list(values)
    return math.fsum(numbers) / len(numbers) if numbers else math.nan


def _row(cells: dict[str, str]) -> CurvePoint:
    """Return a row; no count is below zero or of more than 64 bits, and no mean is infinite."""
    names = [column.name for column in fields(CurvePoint) if column.name in cells or column.default is MISSING]
    numbers = {name: int(cells[name]) if name in COUNTS else float(cells[name] or "nan") for name in names}
    for value in numbers.values():
        if (isinstance(value, int) and bounded(value) < 0) or math.isinf(value):
            raise ValueError(f"{value} is a number that no training has")
    return CurvePoint(**dict[str, Any](numbers))


COUNTS = ("steps", "episodes", "unfinished")
"""Columns of whole numbers; the last is missing in curves of earlier versions."""
