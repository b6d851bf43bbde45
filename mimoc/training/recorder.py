"""Recording a learning curve during training."""

from collections.abc import Callable
from time import perf_counter

from stable_baselines3.common.callbacks import BaseCallback

from mimoc.training.checkpoint import Progress
from mimoc.training.curve import Curve, FinishedEpisode, Row, summarize

ROW_STEPS = 4096
"""Control steps per row of a learning curve; the last row of an interval may cover fewer."""


class Recorder(BaseCallback):
    """Callback that extends a learning curve during a training interval."""

    def __init__(self, before: Progress, step_s: float, report: Callable[[int], None]):
        """Continue the curve of earlier intervals.

        Args:
            before: Progress at the start of the interval.
            step_s: Duration of a control step.
            report: Called at every step with the number of steps taken so far.
        """
        super().__init__()
        self._before, self._step_s, self._report = before, step_s, report
        self._rows: list[Row] = []
        self._ended: list[FinishedEpisode] = []
        self._row_start, self._start_s = before.steps, perf_counter()

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if (episode := info.get("episode")) is not None:
                self._ended.append(FinishedEpisode(float(episode["r"]), int(episode["l"]), bool(info["is_success"])))
        self._report(self.num_timesteps)
        if self.num_timesteps - self._row_start >= ROW_STEPS:
            self._end_row()
        return True

    def progress(self) -> Progress:
        """Return the progress at the end of the interval."""
        if self.num_timesteps > self._row_start:
            self._end_row()
        return Progress(self.num_timesteps, self._wall_s(), Curve((*self._before.curve.rows, *self._rows)))

    def _end_row(self) -> None:
        self._rows.append(summarize(self._ended, self.num_timesteps, self._step_s, self._wall_s()))
        self._ended, self._row_start = [], self.num_timesteps

    def _wall_s(self) -> float:
        return round(self._before.wall_s + perf_counter() - self._start_s, 3)
