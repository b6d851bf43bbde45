"""Trials by seed, side by side in several processes; what is finished outlives an interruption."""

import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mimoc.bundle.files import make_folder, remove, write_file
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.schema.base import Model
from mimoc.schema.quantities import Real
from mimoc.studies.experiments.notebook import Notebook
from mimoc.studies.processes import process_pool

FOLDER = "trials"
"""Where finished trials are kept until all of them are."""


class Result(Model):
    """What came of a trial."""

    values: Mapping[str, Real]
    """Measures by name; what did not happen is left out."""
    traces: Mapping[str, tuple[Real, ...]] = {}
    """Curves by name."""


@dataclass(frozen=True, slots=True)
class Trial:
    """Something that is done with an infant, once for a seed."""

    run: Callable[[Any, int], Result]
    """A function of a module, from what is tried and a seed to what came of it."""
    case: Any
    """What is tried: a frozen dataclass of plain values."""
    seed: int


def run_trials(notebook: Notebook, trials: Sequence[Trial]) -> list[Result]:
    """Return what came of trials, in their order; those that an earlier run has finished are not repeated.

    Quick experiments run in this process, others in as many as there are processors.

    Raises:
        OutputError: If a result cannot be written.
    """
    folder, count = notebook.folder, notebook.counter(len(trials))
    results = {slot: result for slot, trial in enumerate(trials) if (result := _read(folder, trial))}
    for _ in results:
        count(None)
    waiting = [slot for slot in range(len(trials)) if slot not in results]

    def keep(slot: int, result: Result) -> None:
        _write(folder, trials[slot], result)
        results[slot] = count(result)

    if notebook.quick:
        for slot in waiting:
            keep(slot, _run(trials[slot]))
    else:
        _run_side_by_side(trials, waiting, keep)
    return [results[slot] for slot in range(len(trials))]


def forget_trials(notebook: Notebook) -> None:
    """Remove the results of an experiment that has ended, so that the next one begins anew."""
    remove(notebook.folder / FOLDER)


def _run_side_by_side(trials: Sequence[Trial], waiting: Sequence[int], keep: Callable[[int, Result], None]) -> None:
    pool = process_pool(os.cpu_count() or 1)
    try:
        running = {pool.submit(_run, trials[slot]): slot for slot in waiting}
        for future in as_completed(running):
            keep(running[future], future.result())
    finally:
        pool.shutdown(cancel_futures=True)


def _run(trial: Trial) -> Result:
    return trial.run(trial.case, trial.seed)


def _file(folder: Path, trial: Trial) -> Path:
    """Return the file of a trial, whose name tells trials and versions of the software apart."""
    name = trial.run.__name__.strip("_")
    versions = [version(library) for library in ("mimoc", "mujoco", "numpy")]
    identity = [trial.run.__module__, name, asdict(trial.case), trial.seed, versions]
    digest = hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()
    return folder / FOLDER / f"{name}-{digest[:16]}.json"


def _write(folder: Path, trial: Trial, result: Result) -> None:
    path = _file(folder, trial)
    make_folder(path.parent, below=folder)
    write_file(path, f"{result.model_dump_json()}\n".encode(), below=folder)


def _read(folder: Path, trial: Trial) -> Result | None:
    """Return what came of a trial; None if there is nothing, or it is damaged, so that it is done again."""
    try:
        return read_json_file(_file(folder, trial), Result, below=folder)
    except UnusableFileError:
        return None
