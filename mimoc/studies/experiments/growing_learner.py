"""An infant that has learnt to reach while it grew, and its performance at the oldest age."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from mimoc.training import Episode, Training


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
