"""The learning curve of a training on a device, where the outcomes of episodes are added up."""

import math
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import torch

from mimoc.training.checkpoint import Progress
from mimoc.training.curve import Curve, CurvePoint
from mimoc.training.tracking import ROW_STEPS

SUMS = ("episodes", "return", "steps", "successes", "steps to success", "overflowed")
"""What is added up of the episodes that ended."""


class DeviceCurve:
    """Extends a learning curve during a training interval; the CPU waits for the device once a row.

    The first episode of each infant does not count: it is cut at a random time, see `Share.spread`.
    """

    def __init__(self, before: Progress, step_s: float, envs: int, device: Any, on_row: Callable[[CurvePoint], None]):
        """Continue the curve of earlier intervals, of control steps of *step_s*; *on_row* gets each new row."""
        self._before, self._step_s, self._on_row = before, step_s, on_row
        self.steps = self._row_start = before.steps
        """Control steps so far, summed over all infants."""
        self.overflowed = 0
        """Episodes of the interval that were cut because contacts did not fit."""
        self._rows: list[CurvePoint] = []
        self._returns, self._lengths = (torch.zeros(envs, dtype=torch.float64, device=device) for _ in range(2))
        self._is_whole = torch.zeros(envs, dtype=torch.bool, device=device)
        self._sums = torch.zeros(len(SUMS), dtype=torch.float64, device=device)
        self._start_s = perf_counter()

    def add(self, rewards: torch.Tensor, dones: torch.Tensor, extras: Mapping[str, Any]) -> None:
        """Take a control step into account; arrays have the shape (envs,)."""
        self.steps += len(rewards)
        self._returns += rewards
        self._lengths += 1
        counts = dones & self._is_whole
        self._is_whole |= dones
        ends, succeeds = counts.double(), (extras["is_success"] & counts).double()
        overflows = (extras["overflowed"] & dones).double()
        parts = ends, ends * self._returns, ends * self._lengths, succeeds, succeeds * self._lengths, overflows
        self._sums += torch.stack(parts).sum(dim=1)
        for so_far in (self._returns, self._lengths):
            so_far.masked_fill_(dones, 0.0)

    def end_row(self, at_last: bool = False) -> CurvePoint:
        """Return the row of the steps since the row before; it is kept if they are enough, or the last ones."""
        known = dict(zip(SUMS, self._sums.tolist(), strict=True))
        going_on = self._lengths > 0
        count = int(going_on.sum())
        so_far = [float(values.sum()) / count if count else math.nan for values in (self._returns, self._lengths)]
        row = CurvePoint(
            steps=self.steps,
            episodes=int(known["episodes"]),
            episode_return=_share(known["return"], known["episodes"]),
            success_rate=_share(known["successes"], known["episodes"]),
            episode_steps=_share(known["steps"], known["episodes"]),
            time_to_success_s=_share(known["steps to success"], known["successes"]) * self._step_s,
            wall_s=self._wall_s(),
            unfinished=count,
            unfinished_return=so_far[0],
            unfinished_steps=so_far[1],
        )
        if at_last or self.steps - self._row_start >= ROW_STEPS:
            self.overflowed += int(known["overflowed"])
            self._rows.append(row)
            self._row_start = self.steps
            self._sums.zero_()
            self._on_row(row)
        return row

    def progress(self) -> Progress:
        """Return the progress at the end of the interval, or where it was interrupted."""
        if self.steps > self._row_start:
            self.end_row(at_last=True)
        return Progress(self.steps, self._wall_s(), Curve((*self._before.curve.rows, *self._rows)))

    def _wall_s(self) -> float:
        return round(self._before.wall_s + perf_counter() - self._start_s, 3)


def _share(total: float, count: float) -> float:
    return total / count if count else math.nan
