"""Searches for the ages of milestones, in parallel processes, that keep what they have when they are interrupted."""

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

from mimoc.bundle.files import make_folder, remove, write_file
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.schema.quantities import Real
from mimoc.studies.milestones import Conditions, Outcome
from mimoc.studies.milestones.search import SearchResult, search, worker_pool

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
