"""The search for the youngest age from which on a trial succeeds, and searches that an interruption leaves intact."""

import hashlib
import json
import signal
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, as_completed, wait
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path

from mimoc.bundle.files import make_folder, remove, write_file
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.schema.quantities import Real
from mimoc.studies.milestones.infant import Conditions, TrialInfant, compile_at
from mimoc.studies.milestones.trial import Outcome, try_out
from mimoc.studies.milestones.trials import TRIALS

FINE_MONTHS, OLDEST_MONTHS = 0.5, 24.0
COARSE_STRIDE = 2
"""The search descends by every second age of the grid, and then looks at those in between."""

Progress = Callable[[int, int], None]
"""Called with the number of ages done with and their total."""
Trials = Callable[[str, float], Outcome]
"""Returns the outcome of a trial, by name, at an age in months."""


def age_grid(step_months: float = FINE_MONTHS) -> tuple[float, ...]:
    """Return the ages of the search, from birth to two years."""
    return tuple(step_months * index for index in range(round(OLDEST_MONTHS / step_months) + 1))


@dataclass(frozen=True)
class SearchResult:
    """What a search found out about one trial."""

    youngest_months: float | None
    """The youngest age from which on all tried ages succeed; None if the oldest fails."""
    outcomes: Mapping[float, Outcome] = field(default_factory=dict)
    """Outcome by tried age."""

    @property
    def at_birth(self) -> bool:
        """Whether a newborn succeeds."""
        return 0.0 in self.outcomes and self.outcomes[0.0].success


def search_downwards(ages: Sequence[float]) -> Generator[float, bool, float | None]:
    """Yield ages to try, get whether each succeeded, and return the youngest age with success at all older ones.

    It starts at the oldest and takes every second age until one fails, or the youngest succeeds; then it tries those
    between the last success and the first failure. The youngest age of all is tried in any case.
    """
    descending = sorted(ages, reverse=True)
    coarse = [*descending[::COARSE_STRIDE], descending[-1]]
    youngest, failed = None, None
    for age in dict.fromkeys(coarse):
        if not (yield age):
            failed = age
            break
        youngest = age
    for age in descending:
        if failed is not None and youngest is not None and failed < age < youngest:
            if not (yield age):
                break
            youngest = age
    if failed is not None and failed != descending[-1]:
        yield descending[-1]
    return youngest


def search(
    spec: InfantSpec,
    conditions: Conditions,
    names: Sequence[str],
    ages: Sequence[float],
    processes: int = 1,
    progress: Progress | None = None,
) -> Mapping[str, SearchResult]:
    """Return what is found for each trial, by name.

    Args:
        spec: The infant; its age is not used.
        conditions: Conditions of the trials.
        names: The trials.
        ages: Ages to try, in months.
        processes: Number of processes; with 1, everything runs in this one.
        progress: Called after each attempt.
    """
    if processes == 1:
        return _searches(names, ages, progress, lambda name, age: _try_at(spec, conditions, name, age))
    with worker_pool(processes) as pool:
        try:
            return _parallel(pool, spec, conditions, names, ages, progress)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def worker_pool(processes: int) -> ProcessPoolExecutor:
    """Return processes that leave Ctrl-C to their parent."""
    return ProcessPoolExecutor(processes, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN))


def _searches(
    names: Sequence[str], ages: Sequence[float], progress: Progress | None, run: Trials
) -> Mapping[str, SearchResult]:
    results: dict[str, SearchResult] = {}
    for done, name in enumerate(names, start=1):
        one = _Search(ages)
        while one.next_age is not None:
            one.record(run(name, one.next_age))
        results[name] = one.result
        if progress:
            progress(done * len(ages), len(names) * len(ages))
    return results


def _parallel(
    pool: ProcessPoolExecutor,
    spec: InfantSpec,
    conditions: Conditions,
    names: Sequence[str],
    ages: Sequence[float],
    progress: Progress | None,
) -> Mapping[str, SearchResult]:
    """Run the searches of all trials side by side; each waits for its own last attempt."""
    searches = {name: _Search(ages) for name in names}
    waiting: dict[Future[Outcome], str] = {}

    def submit(name: str) -> None:
        age = searches[name].next_age
        if age is not None:
            waiting[pool.submit(_try_at, spec, conditions, name, age)] = name

    for name in names:
        submit(name)
    while waiting:
        for future in wait(waiting, return_when=FIRST_COMPLETED).done:
            name = waiting.pop(future)
            searches[name].record(future.result())
            submit(name)
        if progress:
            progress(sum(one.settled for one in searches.values()), len(names) * len(ages))
    return {name: one.result for name, one in searches.items()}


class _Search:
    """A running search for one trial."""

    def __init__(self, ages: Sequence[float]):
        self._ages = ages
        self._steps = search_downwards(ages)
        self._outcomes: dict[float, Outcome] = {}
        self._youngest: float | None = None
        self.next_age: float | None = next(self._steps)

    def record(self, outcome: Outcome) -> None:
        """Take the outcome at the next age, and find the one after that."""
        if self.next_age is None:
            raise ValueError("this search is over")
        self._outcomes[self.next_age] = outcome
        try:
            self.next_age = self._steps.send(outcome.success)
        except StopIteration as end:
            self.next_age, self._youngest = None, end.value

    @property
    def settled(self) -> int:
        """How many ages there is nothing more to find out about."""
        if self.next_age is None:
            return len(self._ages)
        return sum(age > min(self._outcomes, default=self._ages[-1]) for age in self._ages)

    @property
    def result(self) -> SearchResult:
        return SearchResult(self._youngest, dict(sorted(self._outcomes.items())))


def _try_at(spec: InfantSpec, conditions: Conditions, name: str, age_months: float) -> Outcome:
    return try_out(TRIALS[name], _infant_at(spec.model_dump_json(), age_months, conditions), conditions)


@lru_cache(maxsize=64)
def _infant_at(spec: str, age_months: float, conditions: Conditions) -> TrialInfant:
    """Return an infant, compiled once by each process; specs themselves cannot be hashed."""
    return compile_at(InfantSpec.model_validate_json(spec), age_months, conditions)


FOLDER = "searches"
"""Where finished searches are kept until all of them are."""


@dataclass(frozen=True, slots=True)
class Case:
    """A milestone of the average child that follows a law, under some conditions."""

    development: Development
    trial: str
    ages: tuple[float, ...]
    """The ages that may be tried, in months, the youngest first."""
    conditions: Conditions
    near_months: float | None = None
    """One of the ages, from which on others are tried step by step; None means from the oldest down."""


def run_searches(
    cases: Sequence[Case], folder: Path, processes: int, finished: Callable[[], None]
) -> Mapping[Case, SearchResult]:
    """Return what is found in each case; the searches that an earlier run has finished in this folder are not repeated.

    Args:
        cases: What to search for.
        folder: Where each result is written as soon as it is there.
        processes: Number of processes; with 1, everything runs in this one.
        finished: Called after each search.

    Raises:
        OutputError: If a result cannot be written.
    """
    results: dict[Case, SearchResult] = {}
    for case, result in _all(cases, folder, processes):
        results[case] = result
        finished()
    return {case: results[case] for case in cases}


def forget_searches(folder: Path) -> None:
    """Remove the results of an experiment that has ended, so that the next one begins anew."""
    remove(folder / FOLDER)


def _all(cases: Iterable[Case], folder: Path, processes: int) -> Iterator[tuple[Case, SearchResult]]:
    missing = []
    for case in cases:
        if (kept := _read(folder, case)) is not None:
            yield case, kept
        else:
            missing.append(case)
    for case, result in _searched(missing, processes):
        _write(folder, case, result)
        yield case, result


def _searched(cases: Sequence[Case], processes: int) -> Iterator[tuple[Case, SearchResult]]:
    """Yield the results, in the order in which they come."""
    if processes == 1:
        for case in cases:
            yield case, _search(case)
        return
    with worker_pool(processes) as pool:
        try:
            running = {pool.submit(_search, case): case for case in cases}
            for future in as_completed(running):
                yield running[future], future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _search(case: Case) -> SearchResult:
    spec = InfantSpec(mimoc=1, name="average_child", age_months=0, development=case.development)

    def find(ages: Sequence[float]) -> SearchResult:
        return search(spec, case.conditions, [case.trial], ages)[case.trial]

    if case.near_months is None:
        return find(case.ages)
    return walk(case.ages, case.near_months, lambda age: find([age]).outcomes[age])


def walk(ages: Sequence[float], near_months: float, run: Callable[[float], Outcome]) -> SearchResult:
    """Return the age that a milestone moves to from a given age: down while it succeeds, or up until it does.

    Args:
        ages: Ages to try, the youngest first.
        near_months: The one to begin with.
        run: Returns the outcome at an age.
    """
    at = ages.index(near_months)
    outcomes = {near_months: run(near_months)}
    if outcomes[near_months].success:
        others, wanted = reversed(ages[:at]), False
    else:
        others, wanted = iter(ages[at + 1 :]), True
    for age in others:
        outcomes[age] = run(age)
        if outcomes[age].success is wanted:
            break
    succeeded = [age for age, outcome in outcomes.items() if outcome.success]
    return SearchResult(min(succeeded, default=None), dict(sorted(outcomes.items())))


def _file(folder: Path, case: Case) -> Path:
    """Return the file of a search, whose name tells cases and versions of the software apart."""
    versions = [version(library) for library in ("mimoc", "mujoco", "numpy")]
    digest = hashlib.sha256(json.dumps([asdict(case), versions], sort_keys=True).encode()).hexdigest()
    return folder / FOLDER / f"{case.development}-{case.trial}-{digest[:12]}.json"


class _SearchFile(Model):
    """What the file of a search contains."""

    youngest_months: Real | None
    tried: tuple[tuple[Real, Outcome], ...]
    """Ages in months, and what came of them."""


def _write(folder: Path, case: Case, result: SearchResult) -> None:
    path = _file(folder, case)
    make_folder(path.parent, below=folder)
    data = _SearchFile(youngest_months=result.youngest_months, tried=tuple(result.outcomes.items()))
    write_file(path, f"{data.model_dump_json(indent=1)}\n".encode(), below=folder)


def _read(folder: Path, case: Case) -> SearchResult | None:
    """Return the result of a search; None if there is none, or it is damaged, so that it is done again."""
    try:
        file = read_json_file(_file(folder, case), _SearchFile, below=folder)
    except UnusableFileError:
        return None
    return None if file is None else SearchResult(file.youngest_months, dict(file.tried))
