"""All attempts to learn a skill, at several ages and with several seeds: each is kept as soon as it is done."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from mimoc.base.errors import SpecError
from mimoc.bundle.files import make_folder
from mimoc.policies.postures import Postures
from mimoc.runtime.opening.environments import open_infant
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.studies.kept_results import keep, kept_file, process_pool, read_kept
from mimoc.studies.skills.search import search


class Attempt(Model):
    """One search at one age."""

    age_months: float
    """The infant's age."""
    seed: int
    """Seed of the search."""
    success: float
    """Share of starts in which it has the skill."""
    starts: int
    """Number of these starts."""
    tried: int = 0
    """Number of movements tried, or of control steps of a training."""
    curve: tuple[float, ...] = ()
    """Mean score of the best tries in each round, or the share of episodes with success in each row of a training."""
    movement: Postures | None = None
    """The movement that a search found; None if a policy was trained, or the infant cannot even begin."""
    policy: str = ""
    """Path of the policy that was trained on a device, from the folder of the results."""
    success_on_device: float | None = None
    """Share of the infants that had success there with the same policy, one episode each."""
    problem: str = ""
    """Why it cannot begin."""


def problem_of(error: SpecError) -> str:
    """Return why a task cannot begin, without the place in a spec."""
    return str(error).partition("task.kind: ")[2] or str(error)


Job = tuple[InfantSpec, int]  # The infant that is to learn a skill, and the seed.
ProgressCallback = Callable[[int, int], None]  # Called with how much is done, and how much there is to do.


@dataclass(frozen=True)
class Way:
    """A way to learn a skill."""

    name: str
    budget: tuple[Any, ...]  # What decides its results besides infant and seed, as plain data.
    made: Callable[[Sequence[Job], ProgressCallback], Iterator[tuple[int, Attempt]]]
    """Yields the place of a job and what came of it, as soon as it is done."""


def attempts_of(jobs: Sequence[Job], way: Way, out: Path, progress: ProgressCallback) -> list[Attempt]:
    """Return what came of all jobs; what the folder has of the same software is not done again."""
    what = [(infant.model_dump(mode="json"), seed, *way.budget) for infant, seed in jobs]
    files = [kept_file(out / "attempts", way.name, *parts) for parts in what]
    done = {place: attempt for place, path in enumerate(files) if (attempt := read_kept(path, Attempt, below=out))}
    missing = [place for place in range(len(jobs)) if place not in done]
    for index, attempt in way.made([jobs[place] for place in missing], progress) if missing else ():
        done[missing[index]] = attempt
        make_folder(out, below=out.parent)
        keep(files[missing[index]], attempt, below=out)
    return [done[place] for place in range(len(jobs))]


def searches(
    jobs: Sequence[Job], progress: ProgressCallback, tries: int, starts: int, processes: int
) -> Iterator[tuple[int, Attempt]]:
    """Search for movements in processes side by side; progress is in searches."""
    progress(0, len(jobs))
    with process_pool(min(processes, len(jobs))) as pool:
        places = {pool.submit(searched, *job, tries, starts): place for place, job in enumerate(jobs)}
        for count, future in enumerate(as_completed(places), 1):
            yield places[future], future.result()
            progress(count, len(jobs))


def searched(spec: InfantSpec, seed: int, tries: int, starts: int) -> Attempt:
    """Return what comes of one search."""
    attempt = partial(Attempt, age_months=spec.age_months, seed=seed, starts=starts)
    try:
        env = open_infant(spec)
    except SpecError as error:
        return attempt(success=0.0, problem=problem_of(error))
    outcome = search(env, seed, tries, starts)
    env.close()
    recipe = {"learner": "cross-entropy search", "seed": float(seed), "success": outcome.success}
    movement = outcome.movement.model_copy(update={"recipe": {**recipe, "tried": float(outcome.tried)}})
    return attempt(success=outcome.success, tried=outcome.tried, curve=outcome.curve, movement=movement)
