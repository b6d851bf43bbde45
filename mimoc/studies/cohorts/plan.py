"""What a cohort will take: its jobs, their time, and their space, from a short trial of each step."""

import os
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.engines.local import try_out
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.store import ASSETS, Result, Store, size_bytes
from mimoc.studies.cohorts.table import varied_options
from mimoc.studies.jobs import Progress

TRIAL_S = 30.0  # Longest trial of a step; a step that takes longer is counted as this long.
SHORT, LONG = 50, 150  # Control steps of two trial runs, whose difference says how long a step takes.


@dataclass(frozen=True, slots=True)
class StepPlan:
    """What a step of a cohort will take."""

    step: str  # Its name, with the options that tell it from other steps of this name.
    jobs: int
    done: int  # Jobs that have a result already.
    seconds: float | None  # CPU time of a job on one core, from its trial; None if there was none, as all are done.
    at_least: bool  # Whether the trial was stopped, so that jobs take longer than that.
    bytes: float  # Size of what a job leaves behind; 0 if there was no trial.
    error: str  # Why the trial failed; empty if it did not.


@dataclass(frozen=True, slots=True)
class Plan:
    """What a cohort will take."""

    infants: int
    steps: tuple[StepPlan, ...]
    processes: int  # Processes that this machine would use.

    @property
    def jobs(self) -> int:
        """Number of all jobs."""
        return sum(step.jobs for step in self.steps)

    @property
    def hours(self) -> float:
        """Time that the missing jobs take on this machine."""
        seconds = sum((step.jobs - step.done) * (step.seconds or 0.0) for step in self.steps)
        return seconds / self.processes / 3600

    @property
    def bytes(self) -> float:
        """Size of what the missing jobs leave behind."""
        return sum((step.jobs - step.done) * step.bytes for step in self.steps)


def plan(cohort: Cohort, out: str | Path, progress: Progress = lambda done, total: None) -> Plan:
    """Return what a cohort will take, after a trial of each step that is not done; nothing is written to its folder.

    Raises:
        MimocError: If it cannot be run, or the folder holds anything else.
    """
    jobs, store = cohort.jobs(), Store(Path(out).expanduser())
    store.check_usable()
    cohort.check_steps()
    steps, estimates = _by_step(jobs), list[StepPlan]()
    for step, alike in steps.items():
        progress(len(estimates), len(steps))
        estimates.append(_planned(step, alike, store))
    return Plan(len(cohort.infants), tuple(estimates), len(os.sched_getaffinity(0)))


def _by_step(jobs: Sequence[Job]) -> dict[str, list[Job]]:
    """Return the jobs of each step with the same options, which take alike long, by what is said of it."""
    varied, by_name = varied_options(jobs), dict[str, list[Job]]()
    for job in jobs:
        options = ", ".join(f"{name} {job.options[name]}" for step, name in varied if step == job.step)
        by_name.setdefault(f"{job.step} ({options})" if options else job.step, []).append(job)
    return by_name


def _planned(step: str, jobs: Sequence[Job], store: Store) -> StepPlan:
    missing = store.missing(jobs)
    if not missing:
        return StepPlan(step, len(jobs), len(jobs), None, False, 0.0, "")
    place = tempfile.mkdtemp(prefix="mimoc-trial-")
    try:
        trial = Store(Path(place))
        trial.create(missing[0].cohort)
        trials = _trials(missing[0], missing[-1])
        results = try_out(trials, trial, TRIAL_S)
        size = size_bytes(trial.folder) - size_bytes(trial.folder / ASSETS)
        recorded = _recorded_bytes(missing[-1], trials, trial)
    finally:
        shutil.rmtree(place, ignore_errors=True)
    finished = [result for result in results if result]
    at_least = len(finished) < len(trials)
    seconds = TRIAL_S if at_least else _seconds(missing[-1], trials, finished)
    error = next((result.error for result in finished if not result.ok), "")
    return StepPlan(
        step, len(jobs), len(jobs) - len(missing), seconds, at_least, size / max(len(finished), 1) + recorded, error
    )


def _trials(first: Job, job: Job) -> list[Job]:
    """Return jobs that take little time and say how long a job takes: the first of them is for warming up."""
    if job.step == "experiment":
        return [job]
    if job.step not in ("run", "train") or job.options["steps"] <= LONG:
        return [replace(first, key="0" * 32), replace(job, key="1" * 32)]
    short, long = (SHORT, LONG) if job.step == "run" else _rollouts(job)
    lengths = [(first, short), (job, short), (job, short), (job, long)]
    return [
        replace(trial, key=f"{number:032x}", options={**trial.options, "steps": steps})
        for number, (trial, steps) in enumerate(lengths)
    ]


def _seconds(job: Job, trials: Sequence[Job], results: Sequence[Result]) -> float:
    """Return how long a job takes: with its infant built, and in proportion to its steps if the trials had fewer."""
    if len(trials) <= 2:
        return results[-1].seconds
    *_, short, long = (trial.options["steps"] for trial in trials)
    rate = max(results[-1].seconds - results[-2].seconds, 0.0) / (long - short)
    return results[1].seconds + rate * (job.options["steps"] - short)


def _recorded_bytes(job: Job, trials: Sequence[Job], store: Store) -> float:
    """Return how much larger the recording of a job is than those of its trials on average, if they had fewer steps."""
    if len(trials) <= 2 or not job.options.get("record"):
        return 0.0
    steps = [trial.options["steps"] for trial in trials]
    short, long = (size_bytes(store.runs(trial)) for trial in trials[-2:])
    return (long - short) / (steps[-1] - steps[-2]) * (job.options["steps"] - sum(steps) / len(steps))


def _rollouts(job: Job) -> tuple[int, int]:
    from mimoc.training.settings import TrainingSettings

    named = {name: job.options[name] for name in ("algo", "steps", "envs", "checkpoint_every", "hyper")}
    rollout = max(TrainingSettings.choose(seed=0, **named).rollout_steps, 1024)
    return rollout, 2 * rollout
