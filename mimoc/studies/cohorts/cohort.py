"""Cohorts: reading one, doing its jobs, and gathering its table."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import MimocError, MissingExtraError, SpecError
from mimoc.policies.spec import parse_policy
from mimoc.schema import source as sources
from mimoc.schema.base import plain
from mimoc.schema.cohort_file import COHORT, CohortSpec
from mimoc.schema.cohort_steps import ExperimentStep, RunStep, TrainStep, step_of
from mimoc.schema.infant import InfantSpec, read_spec
from mimoc.schema.reading import read_keys
from mimoc.schema.source import Source
from mimoc.studies.cohorts.engines import find_engine
from mimoc.studies.cohorts.infants import CohortInfant, infants_of
from mimoc.studies.cohorts.job import Job, jobs_of
from mimoc.studies.cohorts.run_jobs import failed_result
from mimoc.studies.cohorts.store import Store
from mimoc.studies.cohorts.table import MISSING, Cell, rows_of, write_csv, write_parquet
from mimoc.studies.jobs import Progress


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
        engine, store, share = find_engine(on, options), Store(Path(out).expanduser()), self.jobs()[index::of]
        self.check_steps()
        store.create(self.spec.cohort)
        todo = store.missing(share)
        ready, report = len(share) - len(todo), progress or (lambda done, total: None)
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
        rows, folder = self.rows(out, progress=progress), Path(out).expanduser()
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
