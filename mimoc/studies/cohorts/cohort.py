"""Cohorts: reading one, saying what it will take, doing its jobs, and gathering its table."""

import os
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import MimocError, MissingExtraError, SpecError, check_name
from mimoc.base.kinds import function_of
from mimoc.policies.spec import parse_policy
from mimoc.schema import source as sources
from mimoc.schema.base import plain
from mimoc.schema.cohort_file import COHORT, CohortSpec, ExperimentStep, RunStep, TrainStep, step_of
from mimoc.schema.infant import InfantSpec, read_spec
from mimoc.schema.kinds import ENGINES
from mimoc.schema.reading import read_keys
from mimoc.schema.source import Source
from mimoc.studies.cohorts.infants import CohortInfant, infants_of
from mimoc.studies.cohorts.job import Job, jobs_of
from mimoc.studies.cohorts.local import try_out
from mimoc.studies.cohorts.run_jobs import failed_result
from mimoc.studies.cohorts.store import ASSETS, Result, Store, size_bytes
from mimoc.studies.cohorts.table import MISSING, Cell, rows_of, varied_options, write_csv, write_parquet
from mimoc.studies.jobs import Progress

Done = Callable[[int], None]  # Called with the number of jobs that have a result now.
Engine = Callable[[Sequence[Job], Store, Mapping[str, Any], Done], None]


def find_engine(name: str, options: Mapping[str, Any]) -> Engine:
    """Return an engine that can run with some options; raise a MimocError if none can."""
    engine = ENGINES.find(name)
    for option in options:
        check_name(f"setting of '--on {name}'", option, engine.options)
    function_of(engine.check, "check")(options)
    return function_of(engine.run, "run")


@dataclass(frozen=True, slots=True)
class Failure:
    """A job that failed."""

    job: Job
    error: str
    log: Path


@dataclass(frozen=True, slots=True)
class Status:
    """How far the jobs of a cohort are."""

    counts: Mapping[str, Mapping[str, int]]  # Number of jobs that are `ok`, `failed` or `missing`, by step.
    failures: tuple[Failure, ...]

    def number(self, state: str) -> int:
        """Return the number of jobs in a state: `ok`, `failed` or `missing`."""
        return sum(counts.get(state, 0) for counts in self.counts.values())

    @property
    def jobs(self) -> int:
        """Number of all jobs."""
        return sum(sum(counts.values()) for counts in self.counts.values())


class Cohort:
    """A study of many infants: see `docs/cohorts.md` for its file.

    Example:
        >>> import mimoc
        >>> study = mimoc.Cohort("study.yaml")
        >>> len(study.specs), len(study.jobs())  # Two children, two ages; one step.
        (4, 4)
        >>> study.specs[0].age_months
        6.0
    """

    def __init__(self, source: str | Path | Source | Mapping[str, Any]):
        """Read a cohort.

        Args:
            source: Path of its file, or what would be in it as a dictionary, with paths relative to the working folder.

        Raises:
            SpecError: If it, or the spec of its infants, is invalid; the error lists all problems.
        """
        if isinstance(source, Mapping):
            source = sources.in_memory(plain(source), "<cohort>", Path())
        self._source = source if isinstance(source, Source) else sources.read(source, COHORT)
        spec = _tried(lambda source: read_keys(CohortSpec, source), self._source)
        base = _tried(_base, self._source)
        if problems := [problem for part in (spec, base) if isinstance(part, SpecError) for problem in part.problems]:
            raise SpecError(problems)
        self.spec: CohortSpec = spec
        self._base: Source = base

    def __repr__(self) -> str:
        return f"Cohort({self.spec.cohort!r}, {self._source.file!r})"

    @cached_property
    def infants(self) -> tuple[CohortInfant, ...]:
        """All its infants, each with the factors that tell it from the others.

        Raises:
            SpecError: If some combinations of values are invalid.
        """
        return infants_of(self.spec, self._source, self._base)

    @property
    def specs(self) -> tuple[InfantSpec, ...]:
        """The specs of all its infants."""
        return tuple(infant.spec for infant in self.infants)

    @cached_property
    def _jobs(self) -> tuple[Job, ...]:
        return jobs_of(self.spec, self.infants, self._source.folder, self._base.folder)

    def jobs(self) -> tuple[Job, ...]:
        """Return all its jobs, in the order of the table.

        Raises:
            SpecError: If some combinations of values are invalid.
            MimocError: If a module or a policy that it names does not exist.
        """
        return self._jobs

    def check_steps(self) -> None:
        """Check that there are the policies, experiments and settings of trainings that its steps name.

        Raises:
            SpecError: If some are unknown or impossible; the error lists all, with their places.
            MissingExtraError: If it trains, and Stable-Baselines3 is not installed.
        """
        problems = []
        for index, item in enumerate(self.spec.do):
            name, step = step_of(item)
            try:
                if isinstance(step, RunStep):
                    parse_policy(step.policy)
                elif isinstance(step, ExperimentStep):
                    # Takes time to import, in each process that does jobs.
                    from mimoc.studies.experiment import find_experiment, law_of

                    law_of(find_experiment(step.name), step.development)
                elif isinstance(step, TrainStep):
                    from mimoc.training import growth_settings  # Needs Stable-Baselines3.
                    from mimoc.training.settings import TrainingSettings

                    growth_settings(step.grow, step.schedule, step.grow_steps, step.steps)
                    settings = step.algo, step.steps, 0, step.envs, step.checkpoint_every, step.hyper
                    TrainingSettings.choose(*settings, steps_per_episode=step.steps_per_episode)
            except MissingExtraError:
                raise
            except MimocError as error:
                problems.append(self._source.problem(("do", index, name), str(error)))
        if problems:
            raise SpecError(problems)

    def run(
        self,
        out: str | Path,
        on: str = "local",
        *,
        index: int = 0,
        of: int = 1,
        progress: Progress | None = None,
        **options: Any,
    ) -> Status:
        """Do all jobs that have no result yet.

        Args:
            out: Folder of the cohort: new, empty, or that of an earlier run.
            on: Where: `local`, in processes on this machine; `slurm` or `ray`, on a cluster that shares the folder.
            index: Which share of the jobs to do, if others do the rest.
            of: Number of shares.
            progress: Called with the number of jobs done and their total.
            options: For the engine. Of `local`: `processes`, by default as many as cores may be used. Of `slurm`:
                `partition`, `time_min`, `memory_gb`, `array_limit`, `jobs_per_task`. Of `ray`: `address`, by default
                a fresh cluster on this machine; `jobs_per_task`.

        Raises:
            SpecError: See `infants` and `check_steps`.
            OutputError: If the folder holds anything else, or cannot be written.
            MimocError: If there is no such share, or the engine cannot run.
        """
        if not 0 <= index < of:
            raise MimocError(f"there is no share {index} of {of}; count shares from 0 to {of - 1}")
        engine = find_engine(on, options)
        store = Store(Path(out).expanduser())
        share = self.jobs()[index::of]
        self.check_steps()
        store.create(self.spec.cohort)
        todo = store.missing(share)
        ready = len(share) - len(todo)
        report = progress or (lambda done, total: None)
        report(ready, len(share))
        if todo:
            engine(todo, store, options, lambda done: report(ready + done, len(share)))
        for job in store.missing(todo):
            store.write(job, failed_result(job, f"the engine '{on}' has ended without a result"))
        return status_of(share, store)

    def retry(self, out: str | Path, on: str = "local", *, progress: Progress | None = None, **options: Any) -> Status:
        """Do all failed jobs again, and those that have no result yet; see `run`."""
        store = _store(out)
        find_engine(on, options)
        self.check_steps()
        for failure in status_of(self.jobs(), store).failures:
            store.forget(failure.job)
        return self.run(out, on, progress=progress, **options)

    def status(self, out: str | Path) -> Status:
        """Return how far the jobs are.

        Raises:
            MimocError: If the folder is not that of a cohort.
        """
        return status_of(self.jobs(), _store(out))

    def rows(self, out: str | Path, *, progress: Progress = lambda done, total: None) -> list[dict[str, Cell]]:
        """Return the table, one row a job; see `table`.

        Raises:
            MimocError: If the folder is not that of a cohort.
        """
        return rows_of(self.jobs(), _store(out), self.spec.measure, progress)

    def table(
        self, out: str | Path, *, parquet: bool = True, progress: Progress = lambda done, total: None
    ) -> list[Path]:
        """Write the table into the folder, as CSV and as Parquet; return the paths.

        Args:
            out: The folder of the cohort.
            parquet: Whether to write Parquet as well.
            progress: Called with the number of results read and their total.

        Raises:
            MimocError: If the folder is not that of a cohort.
            MissingExtraError: If pyarrow is not installed; the CSV is there then.
        """
        rows = self.rows(out, progress=progress)
        folder = Path(out).expanduser()
        written = [write_csv(rows, folder)]
        return [*written, write_parquet(rows, folder)] if parquet else written


def _store(out: str | Path) -> Store:
    store = Store(Path(out).expanduser())
    store.check()
    return store


@takes("the path of a cohort", *PATH)
def read_cohort(path: str | Path) -> Cohort:
    """Return the cohort in a YAML file.

    Raises:
        SpecError: If it is invalid; the error lists all problems.

    Example:
        >>> import mimoc
        >>> study = mimoc.read_cohort("study.yaml")
        >>> [spec.age_months for spec in study.specs]
        [6.0, 9.0, 6.0, 9.0]
    """
    return Cohort(path)


def _tried(read: Callable[[Source], Any], source: Source) -> Any:
    """Return what was read, or the error, so that the problems of several parts are reported together."""
    try:
        return read(source)
    except SpecError as error:
        return error


def _base(source: Source) -> Source:
    """Return the spec that a cohort names or contains; raise a SpecError if it is invalid."""
    base = source.data.get("base")
    if isinstance(base, Mapping):
        spec = source.section("base")
    elif isinstance(base, str) and base:
        try:
            spec = sources.read(source.folder / Path(base).expanduser())
        except SpecError as error:
            raise SpecError(source.problem(("base",), problem.message) for problem in error.problems) from None
    else:
        return source  # The cohort's own problems say what is wrong with it.
    read_spec(spec)
    return spec


def status_of(jobs: Iterable[Job], store: Store) -> Status:
    """Return how far some jobs are."""
    counts: dict[str, Counter[str]] = {}
    failures = []
    for job in jobs:
        result = store.read(job)
        counts.setdefault(job.step, Counter())[result.status if result else MISSING] += 1
        if result and not result.ok:
            failures.append(Failure(job, result.error, store.log(job)))
    return Status(counts, tuple(failures))


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
