"""Infants trained to reach, of one age or growing, and their performance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.senses.sense import FloatArray
from mimoc.studies.experiments.sensed_reaching import log_dimensionless_jerk, path_ratio, spectral_arc_length
from mimoc.training import Curve, Episode, Training

STEP_MS = 10.0
"""Duration of a control step."""
LAST = 0.2
"""Final fraction of the training over which learning is averaged."""
BINS = 25
"""Number of bins of a plotted learning curve."""


@dataclass(frozen=True, slots=True)
class Learner:
    """An infant trained to reach."""

    delay_ms: float
    seed: int
    training: Training
    reaches: list[Episode]

    @property
    def time_s(self) -> list[float]:
        """Time to reach during training, for each row of the curve; NaN where no episode ended."""
        return times_s(self.training.curve).tolist()

    def last_time_s(self) -> float:
        """Return the mean time to reach at the end of the training."""
        late = self.training.curve.column("steps") > (1 - LAST) * self.training.curve.steps
        return float(np.nanmean(np.array(self.time_s)[late]))

    def success_rate(self) -> float:
        """Return the fraction of reaches after training that touch the ball."""
        return fmean(reach.success for reach in self.reaches)

    def jerk(self) -> float:
        """Return the median log dimensionless jerk of the reaches after training."""
        return _median([smoothness(reach)[0] for reach in self.reaches])

    def arc_length(self) -> float:
        """Return the median spectral arc length of the reaches after training."""
        return _median([smoothness(reach)[1] for reach in self.reaches])

    def detour(self) -> float:
        """Return the median ratio of the hand's path length to the straight distance, after training."""
        return _median([detour(reach) for reach in self.reaches])

    def reach_time_s(self) -> float:
        """Return the mean duration of a reach after training."""
        return fmean(reach.duration_s for reach in self.reaches)


def times_s(curve: Curve) -> FloatArray:
    """Return the mean duration of an episode for each row of a learning curve, shape (n,); NaN where none ended."""
    return curve.column("episode_steps") * ms_to_s(STEP_MS)


def binned_times_s(curve: Curve) -> tuple[FloatArray, FloatArray]:
    """Return the mean steps and the mean time to reach of each bin of a training run, shape (n,) each."""
    steps, found_s = curve.column("steps"), times_s(curve)
    parts = np.array_split(np.arange(len(steps)), min(BINS, len(steps)))
    return (
        np.array([steps[part].mean() for part in parts]),
        np.array([_mean_of_known(found_s[part]) for part in parts]),
    )


def _mean_of_known(values: FloatArray) -> float:
    known = values[~np.isnan(values)]
    return float(known.mean()) if known.size else float("nan")


def smoothness(episode: Episode) -> tuple[float, float]:
    """Return log dimensionless jerk and spectral arc length of the path of the hand."""
    assert episode.path_m is not None
    step_s = episode.duration_s / episode.steps
    return log_dimensionless_jerk(episode.path_m, step_s), spectral_arc_length(episode.path_m, step_s)


def detour(episode: Episode) -> float:
    """Return the ratio of the hand's path length to the straight distance from start to end."""
    assert episode.path_m is not None
    return path_ratio(episode.path_m)


def mean_and_range(values: Sequence[float]) -> str:
    """Return the mean of values, with the least and the greatest, as text."""
    return f"{fmean(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def _median(values: Sequence[float]) -> float:
    known = [value for value in values if not np.isnan(value)]
    return float(np.median(known)) if known else float("nan")


@dataclass(frozen=True, slots=True)
class GrowingLearner:
    """An infant trained to reach by one schedule of growth.

    A reach that fails counts with the full length of its episode in all times.
    """

    schedule: str
    """Name of the schedule of growth."""
    seed: int
    training: Training
    reaches: list[Episode]
    """Its reaches after training, at the oldest age."""
    checks: Mapping[int, list[Episode]]
    """Its reaches at the oldest age at each checkpoint, by the control steps of training; the last one included."""

    def success_rate(self) -> float:
        """Return the fraction of reaches after training that touch the ball."""
        return fmean(reach.success for reach in self.reaches)

    def time_s(self) -> float:
        """Return the mean time to touch after training."""
        return fmean(reach.duration_s for reach in self.reaches)

    def episode_return(self) -> float:
        """Return the mean return after training."""
        return fmean(reach.total_reward for reach in self.reaches)

    def check_times_s(self) -> dict[int, float]:
        """Return the mean time to touch at each checkpoint, by the control steps of training."""
        return {steps: fmean(reach.duration_s for reach in reaches) for steps, reaches in self.checks.items()}

    def time_over_checkpoints_s(self) -> float:
        """Return the mean of these times: the smaller, the sooner it has learnt to reach with the oldest body."""
        return fmean(self.check_times_s().values())


def by_schedule(learners: Sequence[GrowingLearner]) -> dict[str, list[GrowingLearner]]:
    """Return the infants of each schedule, in the order of their first appearance."""
    names = dict.fromkeys(learner.schedule for learner in learners)
    return {name: [learner for learner in learners if learner.schedule == name] for name in names}
