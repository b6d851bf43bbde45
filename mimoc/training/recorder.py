"""What is written down while an infant learns."""

from collections.abc import Callable
from time import perf_counter

from stable_baselines3.common.callbacks import BaseCallback

from mimoc.training.checkpoint import Progress
from mimoc.training.curve import Curve, Finished, Row, sum_up

ROW_STEPS = 4096
"""Control steps that a row of a learning curve is about; the last of an interval may be about fewer."""


class Recorder(BaseCallback):
    """Adds rows to a learning curve during an interval of training."""

    def __init__(self, before: Progress, step_s: float, tell: Callable[[int], None]):
        """Go on with what was known before.

        Args:
            before: How far the training had come.
            step_s: A control step.
            tell: Is told at every step how many have been taken.
        """
        super().__init__()
        self._before, self._step_s, self._tell = before, step_s, tell
        self._rows: list[Row] = []
        self._ended: list[Finished] = []
        self._row_began, self._began_s = before.steps, perf_counter()

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if (episode := info.get("episode")) is not None:
                self._ended.append(Finished(float(episode["r"]), int(episode["l"]), bool(info["is_success"])))
        self._tell(self.num_timesteps)
        if self.num_timesteps - self._row_began >= ROW_STEPS:
            self._end_row()
        return True

    def progress(self) -> Progress:
        """Return how far the training has come at the end of the interval."""
        if self.num_timesteps > self._row_began:
            self._end_row()
        return Progress(self.num_timesteps, self._wall_s(), Curve((*self._before.curve.rows, *self._rows)))

    def _end_row(self) -> None:
        self._rows.append(sum_up(self._ended, self.num_timesteps, self._step_s, self._wall_s()))
        self._ended, self._row_began = [], self.num_timesteps

    def _wall_s(self) -> float:
        return round(self._before.wall_s + perf_counter() - self._began_s, 3)
