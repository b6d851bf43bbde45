"""Trials by seed, side by side in several processes; what is finished outlives an interruption."""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mimoc.bundle.files import remove
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
    """Return what came of trials, in their order; those that the same software finished earlier are kept."""
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
