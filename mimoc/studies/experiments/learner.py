"""Infants trained to reach, with a delay or by a schedule of growth, and their performance."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import fmean
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.quantities import TRAINED, Quantity
from mimoc.base.units import ms_to_s
from mimoc.bundle.files import check_unlinked
from mimoc.bundle.io import Bundle
from mimoc.motion.hand_movement import Movement
from mimoc.render.plots import Band, Line, Plot
from mimoc.runtime.quantities import EpisodeResult
from mimoc.runtime.sense import FloatArray
from mimoc.studies.jobs import Progress
from mimoc.studies.notebook import Cell, Notebook
from mimoc.training import Curve, Training, train

STEP_MS = 10.0  # Duration of a control step.
LAST = 0.2  # Final fraction of the training over which learning is averaged.
BINS = 25  # Number of bins of a plotted learning curve.
FIRST_BALL = 1000  # Seed of the first ball, which is not the seed of any training run.
LIBRARIES = ("gymnasium", "stable-baselines3", "torch")  # Libraries that the results of trained infants depend on.
THOUSANDS = replace(TRAINED, unit="thousands")


@dataclass(frozen=True, slots=True)
class Learner:
    """An infant trained to reach; a reach that fails counts with the full length of its episode in all times."""

    group: str  # What tells it from others: its delay in ms, or its schedule of growth.
    seed: int
    training: Training
    reaches: list[EpisodeResult]  # Its reaches after training.
    checks: Mapping[int, list[EpisodeResult]] = field(default_factory=dict)
    """Its reaches at each checkpoint, by the control steps of training; the last one included."""

    def last_time_s(self) -> float:
        """Return the mean time to reach at the end of the training; NaN if no reach ended then."""
        late = self.training.curve.column("steps") > (1 - LAST) * self.training.curve.steps
        return _of_known(np.mean, times_s(self.training.curve)[late])

    def success_rate(self) -> float:
        """Return the fraction of reaches after training that touch the ball."""
        return fmean(reach.success for reach in self.reaches)

    def time_s(self) -> float:
        """Return the mean time to touch after training."""
        return fmean(reach.duration_s for reach in self.reaches)

    def episode_return(self) -> float:
        """Return the mean return after training."""
        return fmean(reach.total_reward for reach in self.reaches)

    def median(self, measure: str) -> float:
        """Return the median of a property of the movements after training; NaN if it is known of none."""
        return _of_known(np.median, np.array([getattr(movement_of(reach), measure) for reach in self.reaches]))

    def mean(self, measure: str) -> float:
        """Return the mean of a property of the movements after training; NaN if it is known of none."""
        return _of_known(np.mean, np.array([getattr(movement_of(reach), measure) for reach in self.reaches]))

    def check_times_s(self) -> dict[int, float]:
        """Return the mean time to touch at each checkpoint, by the control steps of training."""
        return {steps: fmean(reach.duration_s for reach in reaches) for steps, reaches in self.checks.items()}

    def time_over_checkpoints_s(self) -> float:
        """Return the mean of these times: the smaller, the sooner it has learnt to reach."""
        return fmean(self.check_times_s().values())

    def learning(self) -> Iterator[tuple[int, Sequence[Cell]]]:
        """Yield the steps of each row of the learning curve, and its episodes, success rate, time and return."""
        curve = self.training.curve
        for row, time_s in zip(curve.rows, times_s(curve).tolist(), strict=True):
            yield row.steps, (row.episodes, row.success_rate, time_s, row.episode_return)


def trained(notebook: Notebook, name: str, bundle: Bundle, steps: int, progress: Progress, **settings: Any) -> Training:
    """Train an infant in a folder of its own, in which an interrupted training is resumed."""
    folder = check_unlinked(notebook.folder / name, below=notebook.folder)
    training = train(bundle, folder, steps=steps, progress=progress, **settings)
    progress(steps, steps)
    return training


def by_group(learners: Sequence[Learner]) -> dict[str, list[Learner]]:
    """Return the infants of each group, in the order of their first appearance."""
    names = dict.fromkeys(learner.group for learner in learners)
    return {name: [learner for learner in learners if learner.group == name] for name in names}


def movement_of(reach: EpisodeResult) -> Movement:
    """Return the movement of the hand in an episode in which it was tracked."""
    assert reach.path_m is not None
    return Movement(reach.path_m, reach.duration_s / reach.steps)


def mean_and_range(group: Sequence[Learner], measure: Callable[[Learner], float]) -> str:
    """Return the mean of a measure over infants, with the least and the greatest, as text."""
    values = [measure(learner) for learner in group]
    return f"{fmean(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def times_s(curve: Curve) -> FloatArray:
    """Return the mean duration of an episode for each row of a learning curve, shape (n,); NaN where none ended."""
    return curve.column("episode_steps") * ms_to_s(STEP_MS)


def learning_plot(groups: Mapping[str, Sequence[Learner]], y: Quantity, title: str) -> Plot:
    """Return the time to reach over the training, by the label of each group."""
    curves = {}
    for label, group in groups.items():
        steps, durations_s = zip(*(_binned(learner.training.curve) for learner in group), strict=True)
        curves[label] = steps[0], durations_s
    return banded_plot(curves, y, title)


def banded_plot(
    curves: Mapping[str, tuple[npt.ArrayLike, npt.ArrayLike]], y: Quantity, title: str, level: float | None = None
) -> Plot:
    """Return the means over seeds, with bands from the least to the greatest, and a horizontal line at *level*.

    Curves are steps, shape (n,), and values of all seeds, shape (m, n), by label.
    """
    lines, bands = [], []
    for label, (steps, values) in curves.items():
        thousands = np.asarray(steps) / 1000
        all_seeds = np.asarray(values)
        lines.append(Line(thousands, all_seeds.mean(axis=0), label))
        bands.append(Band(thousands, all_seeds.min(axis=0), all_seeds.max(axis=0), label))
    return Plot(THOUSANDS, y, tuple(lines), tuple(bands), title=title, level=level)


def _binned(curve: Curve) -> tuple[FloatArray, FloatArray]:
    steps, durations_s = curve.column("steps"), times_s(curve)
    parts = np.array_split(np.arange(len(steps)), min(BINS, len(steps)))
    return (
        np.array([steps[part].mean() for part in parts]),
        np.array([_of_known(np.mean, durations_s[part]) for part in parts]),
    )


def _of_known(average: Callable[[FloatArray], Any], values: FloatArray) -> float:
    known = values[~np.isnan(values)]
    return float(average(known)) if known.size else float("nan")
