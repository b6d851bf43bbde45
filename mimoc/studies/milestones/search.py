"""The search for the youngest age from which on a trial succeeds, and searches that an interruption leaves intact."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from queue import Queue
from typing import Any

from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.schema.quantities import Real
from mimoc.studies.jobs import JobStore, Progress, Worker, workers
from mimoc.studies.milestones.trial import Conditions, Outcome, compile_once, try_out
from mimoc.studies.milestones.trials import trial_called

AGES: Sequence[float] = [half / 2 for half in range(49)]
"""Ages of the search, in months: every half month from birth to two years."""


def ages_of(spec: InfantSpec) -> Sequence[float]:
    """Return the ages of the search that a child can have: of one that was born early, those from term on."""
    return [age for age in AGES if age >= spec.months_early]


COARSE_STRIDE = 2  # The search descends by every second age of the grid, and then looks at those in between.
NERVOUS_STRIDE = 6
"""The same of infants with a nervous system, which take four times as long for each attempt: by a quarter of a year."""

Try = Callable[[float], Outcome]  # Returns the outcome of a trial at an age in months.
AttemptAt = Callable[[str, Conditions, str, float], Outcome]
"""Returns the outcome for a spec in JSON, conditions, the name of a trial, and an age in months."""


class SearchResult(Model):
    """The result of a search for one trial."""

    youngest_months: Real | None
    """The youngest age from which on all tried ages succeed; None if the oldest fails."""
    outcomes: Mapping[Real, Outcome] = {}
    """Outcome by tried age."""

    @property
    def at_birth(self) -> bool:
        """Whether a newborn succeeds."""
        return 0.0 in self.outcomes and self.outcomes[0.0].success


def search_downwards(ages: Sequence[float], run: Try, stride: int = COARSE_STRIDE) -> SearchResult:
    """Return the youngest age with success at all older ones that were tried.

    It starts at the oldest and takes every second age, or every *stride*-th, until one fails, or the youngest succeeds;
    then it tries those between the last success and the first failure. The youngest age of all is tried in any case.
    """
    outcomes: dict[float, Outcome] = {}

    def succeeds(age: float) -> bool:
        outcomes[age] = run(age)
        return outcomes[age].success

    descending = sorted(ages, reverse=True)
    youngest, failed = None, None
    for age in dict.fromkeys([*descending[::stride], descending[-1]]):
        if not succeeds(age):
            failed = age
            break
        youngest = age
    if failed is not None and youngest is not None:
        for age in descending[descending.index(youngest) + 1 : descending.index(failed)]:
            if not succeeds(age):
                break
            youngest = age
    if descending[-1] not in outcomes:
        succeeds(descending[-1])
    return SearchResult(youngest_months=youngest, outcomes=dict(sorted(outcomes.items())))


def walk(ages: Sequence[float], near_months: float, run: Try) -> SearchResult:
    """Return the age that a milestone moves to from a given age: down while it succeeds, or up until it does."""
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
    youngest = min((age for age, outcome in outcomes.items() if outcome.success), default=None)
    return SearchResult(youngest_months=youngest, outcomes=dict(sorted(outcomes.items())))


EXPECTED_MONTHS: Mapping[str, float] = {
    "prone_head": 2.5,
    "half_squat": 5.5,
    "arm_out": 4.0,
    "no_head_lag": 4.0,
    "sit": 5.5,
    "hands_and_knees": 5.0,
    "pull_to_stand": 6.5,
    "stand": 8.5,
    "leg_lift": 4.0,
    "roll_over": 24.0,
    "supine_head": 5.0,
    "rocking": 6.0,
}
"""Ages at which a child is expected to reach each milestone, by the name of the trial: about those of average children.
Wrong ones cost time, and change nothing where a child that once succeeds does so at every older age."""


def search_near(spec: InfantSpec, conditions: Conditions, name: str) -> SearchResult:
    """Return what is found for a trial near the age at which a child of this rate of maturation is expected to succeed.

    It walks down the half months while the child succeeds, or up until it does: two ages or a few, instead of the
    twenty and more of `search_trials`.
    """
    individual = spec.body.individual
    expected = EXPECTED_MONTHS[name] / ((individual and individual.maturation_rate) or 1.0) + spec.months_early
    ages = ages_of(spec)
    near = min(ages, key=lambda age: abs(age - expected))
    return walk(ages, near, partial(_try_at, spec.model_dump_json(), conditions, name))


@dataclass(frozen=True, slots=True)
class Case:
    """A milestone of a child under some conditions."""

    development: Development
    trial: str  # Its name; of one side also `arm_out:left`.
    ages: tuple[float, ...]  # The ages that may be tried, in months, the youngest first.
    conditions: Conditions
    near_months: float | None = None
    """One of the ages, from which on others are tried step by step; None means from the oldest down."""
    spec: str = ""  # The child, in JSON; empty for the average child that follows the law of development.


def search_trials(
    spec: InfantSpec,
    conditions: Conditions,
    names: Sequence[str],
    ages: Sequence[float],
    processes: int = 1,
    progress: Progress | None = None,
) -> Mapping[str, SearchResult]:
    """Return what is found for each trial, by name, of one with sides also `arm_out:left`; progress is in ages."""
    written = spec.model_dump_json()
    results = dict[str, SearchResult]()
    cases = [Case(spec.development, name, tuple(ages), conditions, spec=written) for name in names]
    for place, result in _searched(cases, processes):
        results[names[place]] = result
        if progress:
            progress(len(results) * len(ages), len(names) * len(ages))
    return {name: results[name] for name in names}


def _searched(cases: Sequence[Case], processes: int) -> Iterator[tuple[int, SearchResult]]:
    """Yield the places of cases and the results of their searches, in the order in which they come.

    With several processes, all searches wait side by side for their attempts, which run there.
    """
    if processes == 1:
        for place, case in enumerate(cases):
            yield place, _search(case, _try_at)
        return
    with workers(processes) as made, ThreadPoolExecutor(len(cases) or 1) as threads:
        idle = Queue[Worker]()
        for worker in made:
            idle.put(worker)

        def attempt(*arguments: Any) -> Outcome:
            worker = idle.get()
            worker.begin(_try_at, *arguments)
            outcome = worker.finish()
            idle.put(worker)
            return outcome

        running = {threads.submit(_search, case, attempt): place for place, case in enumerate(cases)}
        for future in as_completed(running):
            yield running[future], future.result()


def _search(case: Case, attempt: AttemptAt) -> SearchResult:
    average = InfantSpec(mimoc=1, name="average_child", age_months=0, development=case.development)
    run = partial(attempt, case.spec or average.model_dump_json(), case.conditions, case.trial)
    if case.near_months is None:
        stride = NERVOUS_STRIDE if case.conditions.are_of_nerves else COARSE_STRIDE
        return search_downwards(case.ages, run, stride)
    return walk(case.ages, case.near_months, run)


def _try_at(spec: str, conditions: Conditions, name: str, age_months: float) -> Outcome:
    trial, side = trial_called(name)
    return try_out(trial, compile_once(spec, age_months, conditions), conditions, side)


FOLDER = "searches"  # Where finished searches are kept until all of them are.


def run_searches(
    cases: Sequence[Case], folder: Path, processes: int, finished: Callable[[int], Any]
) -> Mapping[Case, SearchResult]:
    """Return what is found in each case, or was by the same software in this folder, where each result is kept.

    *finished* is called with the place of each case that has a result.
    """
    keys = [(f"{case.development}-{case.trial}", asdict(case)) for case in cases]
    store = JobStore(folder, FOLDER, SearchResult)
    results = store.complete(keys, lambda places: _searched([cases[place] for place in places], processes), finished)
    return dict(zip(cases, results, strict=True))
