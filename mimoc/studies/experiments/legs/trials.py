"""Trials by seed, side by side, which outlive an interruption, means over seeds, and what conditions change."""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass
from math import comb, sqrt
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from scipy.stats import t

from mimoc.base.geometry.rotations import FloatArray
from mimoc.bundle.files import remove
from mimoc.render.plots.plot import Band
from mimoc.schema.base import Model
from mimoc.schema.quantities import Real
from mimoc.studies.experiments.notebook import Notebook
from mimoc.studies.kept_results import keep, kept_file, process_pool, read_kept

FOLDER = "trials"  # Where finished trials are kept until all of them are.


class Result(Model):
    """What came of a trial."""

    values: Mapping[str, Real]
    """Measures by name; what did not happen is left out."""
    traces: Mapping[str, tuple[Real, ...]] = {}
    """Curves by name."""


@dataclass(frozen=True, slots=True)
class Trial:
    """Something that is done with an infant, once for a seed."""

    run: Callable[[Any, int], Result]  # A function of a module, from what is tried and a seed to what came of it.
    case: Any  # What is tried: a frozen dataclass of plain values.
    seed: int


def run_trials(notebook: Notebook, trials: Sequence[Trial]) -> list[Result]:
    """Return what came of trials, in their order; those that an earlier run of the same software finished are kept.

    Quick experiments run in this process, others in as many as there are processors.
    """
    folder, count = notebook.folder, notebook.counter(len(trials))
    files = [_file(folder, trial) for trial in trials]
    results = {slot: result for slot, file in enumerate(files) if (result := read_kept(file, Result, below=folder))}
    for _ in results:
        count(None)
    waiting = [slot for slot in range(len(trials)) if slot not in results]

    def finish(slot: int, result: Result) -> None:
        keep(files[slot], result, below=folder)
        results[slot] = count(result)

    if notebook.quick:
        for slot in waiting:
            finish(slot, _run(trials[slot]))
    else:
        with process_pool(os.cpu_count() or 1) as pool:
            running = {pool.submit(_run, trials[slot]): slot for slot in waiting}
            for future in as_completed(running):
                finish(running[future], future.result())
    return [results[slot] for slot in range(len(trials))]


def run_cases(
    notebook: Notebook, cases: Sequence[tuple[Callable[[Any, int], Result], Any]], seeds: Sequence[int]
) -> dict[Any, list[Result]]:
    """Return what comes of each case, by a function that tries it with each seed; equal cases are one."""
    functions = {case: function for function, case in cases}
    trials = [Trial(function, case, seed) for case, function in functions.items() for seed in seeds]
    results = iter(run_trials(notebook, trials))
    return {case: [next(results) for _ in seeds] for case in functions}


def write_measures(
    notebook: Notebook, file: str, results: Mapping[Any, Sequence[Result]], seeds: Sequence[int], **columns: str
) -> None:
    """Write a CSV with a row for each case, seed and measure; columns are attributes of cases by their headings."""
    rows = (
        (*(getattr(case, name) for name in columns.values()), seed, *measure)
        for case, same in results.items()
        for seed, result in zip(seeds, same, strict=True)
        for measure in result.values.items()
    )
    notebook.write_table(file, ",".join((*columns, "seed", "measure", "value")), rows)


def forget_trials(notebook: Notebook) -> None:
    """Remove the results of an experiment that has ended, so that the next one begins anew."""
    remove(notebook.folder / FOLDER)


def _run(trial: Trial) -> Result:
    return trial.run(trial.case, trial.seed)


def _file(folder: Path, trial: Trial) -> Path:
    function = trial.run
    return kept_file(folder / FOLDER, function.__name__.strip("_"), function.__module__, asdict(trial.case), trial.seed)


@dataclass(frozen=True, slots=True)
class Interval:
    """The mean over seeds, and where 95 % of such intervals have the true mean (Student's t)."""

    mean: float
    low: float
    high: float

    def text(self, digits: int = 2, *, percent: bool = False) -> str:
        """Return it as text: `1.23 (1.10 to 1.36)`."""
        if percent:
            return f"{self.mean:+.0%} ({self.low:+.0%} to {self.high:+.0%})"
        return f"{self.mean:.{digits}f} ({self.low:.{digits}f} to {self.high:.{digits}f})"

    def overlaps(self, low: float | None, high: float | None) -> bool:
        """Return whether the mean is inside a range, whose ends can be open."""
        return (low is None or self.mean >= low) and (high is None or self.mean <= high)


def interval(values: Sequence[float]) -> Interval:
    """Return the mean of at least one value with its interval, which is as wide as nothing for a single one."""
    mean = fmean(values)
    if len(values) < 2:
        return Interval(mean, mean, mean)
    half = float(t.ppf(0.975, len(values) - 1)) * stdev(values) / sqrt(len(values))
    return Interval(mean, mean - half, mean + half)


def band_of(x: Sequence[float] | FloatArray, means: Sequence[Interval], label: str = "", look: str = "spread") -> Band:
    """Return the intervals of means along x, shape (n,), as a band of a plot."""
    return Band(x, [mean.low for mean in means], [mean.high for mean in means], label, look)


def band_of_seeds(x: FloatArray, curves: FloatArray, label: str) -> Band:
    """Return the intervals of the means of curves, shape (seeds, n), as a band of a plot."""
    return band_of(x, [interval(column.tolist()) for column in curves.T], label)


def sign_test(changes: Sequence[float]) -> float:
    """Return how likely at least as many rises would be if rises and falls were equally likely; ties are left out.

    >>> sign_test([1.0] * 10 + [-1.0] * 2)
    0.019287109375
    """
    moved = [change > 0 for change in changes if change]
    count, rises = len(moved), sum(moved)
    return sum(comb(count, more) for more in range(rises, count + 1)) / 2**count


LEVEL = 0.05  # Chance below which a direction counts as shown.
Values = Sequence[Mapping[str, float]]  # Measures of each seed.


def relative_changes(plain: Values, changed: Values, measure: str) -> list[float]:
    """Return (c - p) / mean(p) of each seed, p and c being its values without and with a condition.

    Of seeds without a value, nothing is returned; nothing at all if the mean is zero.
    """
    pairs = [(p[measure], c[measure]) for p, c in zip(plain, changed, strict=True) if measure in p and measure in c]
    mean = fmean(before for before, _ in pairs) if pairs else 0.0
    return [(after - before) / mean for before, after in pairs] if mean else []


def change_text(changes: Sequence[float]) -> str:
    """Return a mean change with its interval, and how many seeds it has the direction of."""
    if not changes:
        return "-"
    mean = interval(changes)
    rises = mean.mean > 0
    same = sum((change > 0) == rises for change in changes if change)
    return f"{mean.text(percent=True)}, {same} of {len(changes)}"


def direction(changes: Sequence[float], least: float = 0.0) -> str:
    """Return `more` or `less` if too many seeds change so for chance (p < .05), and the mean by at least some share.

    Otherwise `same`; with so few seeds that not even all of them would do, `unclear`.
    """
    if 0.5 ** len(changes) >= LEVEL:
        return "unclear"
    mean = interval(changes).mean
    if mean >= least and sign_test(changes) < LEVEL:
        return "more"
    return "less" if mean <= -least and sign_test([-change for change in changes]) < LEVEL else "same"
