"""Learning a skill at several ages, with the same budget at each, and how that compares with real infants."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Self

from mimoc.base.kinds import function_of
from mimoc.base.rounding import rounded
from mimoc.bundle.files import write_file
from mimoc.policies.postures import write_postures
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.studies.bench.scores import wilson_interval
from mimoc.studies.bodies import bodies_digest
from mimoc.studies.milestones.report import AgeRange, Verdict, read_age_ranges
from mimoc.studies.skills.attempts import Attempt, Way, attempts_of, searches

TRIES, STARTS, SEEDS, STEPS, ENVS = 1600, 20, 2, 5_000_000, 512
"""How many movements a search tries, in how many starts its result is measured, and how many searches an age
has; control steps and infants of a training on a device."""
LEARNT = 0.5  # Share of starts from which on a skill counts as learnt at an age.
CHILD = {
    "mimoc": 1,
    "name": "average_child",
    "age_months": 6,
    "senses": {"proprioception": {"include": ["velocity"]}, "vestibular": {}},
}

REAL_AGES: Mapping[str, AgeRange] = read_age_ranges(Path(__file__).with_name("ages.csv"))


class AgeResult(Model):
    """What came of all searches at an age."""

    age_months: float
    """The age."""
    success: float
    """Share of starts with success, over all searches."""
    interval: tuple[float, float]
    """95 % interval of that share, as if all starts were independent (Wilson 1927)."""
    searches: tuple[Attempt, ...]
    """The searches, or trainings."""

    @classmethod
    def of(cls, searches: Sequence[Attempt]) -> Self:
        """Return what came of searches at one age."""
        success = sum(attempt.success for attempt in searches) / len(searches)
        starts = sum(attempt.starts for attempt in searches)
        interval = wilson_interval(round(success * starts), starts)
        return cls(age_months=searches[0].age_months, success=success, interval=interval, searches=tuple(searches))

    @property
    def best(self) -> Attempt:
        """The best search."""
        return max(self.searches, key=lambda attempt: attempt.success)


class SkillReport(Model):
    """At what ages an infant can learn a skill, as `results.json` says it."""

    skill: str
    """Its name."""
    from_months: float | None
    """The age at which half of the starts succeed, between two ages by a straight line; None if never."""
    verdict: Verdict
    """How that compares with real infants."""
    real_infants: AgeRange
    """When they have the skill."""
    ages: tuple[AgeResult, ...]
    """What came of it at each age."""
    bodies: str = ""
    """Digest of the bodies at these ages, `bodies_of`."""

    @classmethod
    def of(cls, skill: str, results: Sequence[AgeResult], bodies: str = "") -> Self:
        """Return what the results at all ages say, from the youngest on."""
        real, since = REAL_AGES[skill], _from_months(results)
        is_open = since is None and results[-1].age_months < real.oldest_months
        verdict = "no verdict" if is_open else real.verdict(since)
        ages = tuple(results)
        return cls(skill=skill, from_months=since, verdict=verdict, real_infants=real, ages=ages, bodies=bodies)

    def to_data(self) -> dict[str, Any]:
        """Return everything but movements as plain data, numbers rounded as in files."""
        movements = {"ages": {"__all__": {"searches": {"__all__": {"movement"}}}}}
        return rounded(self.model_dump(mode="json", exclude=movements))


def bodies_of(child: InfantSpec, ages: Sequence[float]) -> str:
    """Return the digest of the bodies of a child at some ages, in [months]; its task is not of the body."""
    return bodies_digest(child.with_(task=None).with_(age_months=age, scene=None) for age in sorted(ages))


def _from_months(results: Sequence[AgeResult]) -> float | None:
    for before, after in zip([None, *results], results, strict=False):
        if after.success >= LEARNT:
            if before is None:
                return after.age_months
            share = (LEARNT - before.success) / (after.success - before.success)
            return before.age_months + share * (after.age_months - before.age_months)
    return None


def learn_skill(
    skill: str,
    ages: Sequence[float],
    out: Path,
    *,
    spec: InfantSpec | None = None,
    options: Mapping[str, Any] | None = None,
    seeds: int = SEEDS,
    tries: int = TRIES,
    starts: int = STARTS,
    processes: int = 1,
    device: str = "cpu",
    steps: int = STEPS,
    envs: int = ENVS,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> SkillReport:
    """Search for a skill at some ages, or train a policy for it on a device, and keep the best of each in a folder.

    Args:
        skill: One of `mimoc.schema.components.tasks.SKILLS`.
        ages: In [months], in any order.
        out: The folder of the results; what is in it already from the same software is not searched again.
        spec: The child; None means the average one.
        options: Keys of the task, such as `style`.
        seeds: Number of searches at each age.
        tries: Movements that each of them tries at most.
        starts: Number of starts in which each result is measured.
        processes: How many searches, or measurements of policies, run side by side.
        device: `cpu` for searches, or where `mimoc.train` trains a policy with each seed instead: `cuda:0`, say.
        steps: Control steps of each of these trainings.
        envs: Number of infants that each of them learns from.
        progress: Called with the number of searches, or of control steps, that are done, and of all.

    Raises:
        SpecError: If the task does not have these options.
        OutputError: If the folder cannot be written.
    """
    child = spec or InfantSpec.model_validate(CHILD)
    task = {"kind": skill, **(options or {})}
    infants = {age: child.with_(task=None).with_(age_months=age, task=task, scene=None) for age in sorted(ages)}
    jobs = [(infant, seed) for infant in infants.values() for seed in range(seeds)]
    if device == "cpu":
        how = partial(searches, tries=tries, starts=starts, processes=processes)
        way = Way("searched", (tries, starts), how)
    else:
        trainings = function_of("mimoc.studies.skills.trainings", "trainings")  # They need what not everyone has.
        how = partial(trainings, steps=steps, starts=starts, device=device, envs=envs, out=out, processes=processes)
        way = Way("trained", (steps, starts, device, envs), how)
    attempts = attempts_of(jobs, way, out, progress)
    results = [AgeResult.of([attempt for attempt in attempts if attempt.age_months == float(age)]) for age in infants]
    for result in results:
        best, name = result.best, f"{skill}_{result.age_months:g}_months"
        if best.movement:
            write_postures(best.movement, out / f"{name}.json")
        elif best.policy:
            write_file(out / f"{name}.zip", (out / best.policy).read_bytes())
    return SkillReport.of(skill, results, bodies_of(child, ages))
