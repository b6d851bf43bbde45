"""Recording a learning curve during training."""

import warnings
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy.typing as npt
from stable_baselines3.common.callbacks import BaseCallback

from mimoc.training.checkpoint import Progress
from mimoc.training.curve import Curve, FinishedEpisode, Row, UnfinishedEpisode, summarize

ROW_STEPS = 4096
"""Control steps per row of a learning curve; the last row of an interval may cover fewer."""
CONSTANT_STEPS = 1000
"""Control steps, summed over all environments, after which a reward that has not changed is a warning."""


class RewardWatch:
    """Warns, once, if the rewards of a training do not change."""

    def __init__(self) -> None:
        """Begin before the first reward."""
        self._first: float | None = None
        self._steps = 0
        self.ended = False
        """Whether there is nothing left to find out."""

    def __call__(self, rewards: npt.NDArray[Any]) -> None:
        """Look at the rewards of a control step, shape (environments,)."""
        self._first = float(rewards[0]) if self._first is None else self._first
        self._steps += len(rewards)
        changes = bool((rewards != self._first).any())
        self.ended = changes or self._steps >= CONSTANT_STEPS
        if self.ended and not changes:
            warnings.warn(
                f"the reward of all {self._steps:,} control steps so far is {self._first:g}: unless it changes, nothing"
                " can be learnt from it; give the spec a task, or train with a task of your own",
                RuntimeWarning,
                stacklevel=2,
            )


class Recorder(BaseCallback):
    """Callback that extends a learning curve during a training interval."""

    def __init__(
        self,
        before: Progress,
        step_s: float,
        report: Callable[[int], None],
        on_row: Callable[[Row], None],
        watch: RewardWatch,
    ):
        """Continue the curve of earlier intervals.

        Args:
            before: Progress at the start of the interval.
            step_s: Duration of a control step.
            report: Called at every step with the number of steps taken so far.
            on_row: Called with each new row of the curve.
            watch: Looks at the rewards.
        """
        super().__init__()
        self._before, self._step_s, self._report = before, step_s, report
        self._on_row, self._watch = on_row, watch
        self._rows: list[Row] = []
        self._ended: list[FinishedEpisode] = []
        self._row_start, self._start_s = before.steps, perf_counter()

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if (episode := info.get("episode")) is not None:
                self._ended.append(FinishedEpisode(float(episode["r"]), int(episode["l"]), bool(info["is_success"])))
        if not self._watch.ended:
            self._watch(self._envs.get_original_reward())
        self._report(self.num_timesteps)
        if self.num_timesteps - self._row_start >= ROW_STEPS:
            self._end_row()
        return True

    def progress(self) -> Progress:
        """Return the progress at the end of the interval, or where it was interrupted."""
        if self.num_timesteps > self._row_start:
            self._end_row()
        steps = max(self.num_timesteps, self._before.steps)
        return Progress(steps, self._wall_s(), Curve((*self._before.curve.rows, *self._rows)))

    @property
    def _envs(self) -> Any:
        """The environments, with the attributes of `VecNormalize` and `VecMonitor`."""
        return self.training_env

    def _end_row(self) -> None:
        row = summarize(self._ended, self.num_timesteps, self._step_s, self._wall_s(), self._unfinished())
        self._rows.append(row)
        self._ended, self._row_start = [], self.num_timesteps
        self._on_row(row)

    def _unfinished(self) -> list[UnfinishedEpisode]:
        so_far = zip(self._envs.episode_returns, self._envs.episode_lengths, strict=True)
        return [UnfinishedEpisode(float(reward), int(steps)) for reward, steps in so_far if steps]

    def _wall_s(self) -> float:
        return round(self._before.wall_s + perf_counter() - self._start_s, 3)
