"""Which body can learn which skill at which age, with the same budget at each, beside the ages of real infants."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Self

from mimoc.base.errors import MimocError
from mimoc.base.quantities import AGE, Quantity
from mimoc.base.rounding import rounded
from mimoc.bundle.files import make_folder, write_file
from mimoc.bundle.regular_files import read_json_file
from mimoc.policies.skill import write_postures
from mimoc.render.plots import Band, Dots, Line, Plot, Sheet
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import SKILLS
from mimoc.studies.bench.scores import wilson_interval
from mimoc.studies.comparison import AgeRange, Verdict, read_figures
from mimoc.studies.growth_plots import AgeRow
from mimoc.studies.jobs import JobStore, Progress
from mimoc.studies.notebook import bodies_digest
from mimoc.studies.skills.search import SkillSearch, searches, trainings

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

REAL_AGES: Mapping[str, AgeRange] = dict(read_figures(Path(__file__).with_name("ages.csv"), AgeRange))


class AgeResult(Model):
    """The results of all searches at an age."""

    age_months: float
    """The age."""
    success: float
    """Share of starts with success, over all searches."""
    interval: tuple[float, float]
    """95 % interval of that share, as if all starts were independent (Wilson 1927)."""
    searches: tuple[SkillSearch, ...]
    """The searches, or trainings."""

    @classmethod
    def of(cls, searches: Sequence[SkillSearch]) -> Self:
        """Return what came of searches at one age."""
        success = sum(attempt.success for attempt in searches) / len(searches)
        starts = sum(attempt.starts for attempt in searches)
        interval = wilson_interval(round(success * starts), starts)
        return cls(age_months=searches[0].age_months, success=success, interval=interval, searches=tuple(searches))

    @property
    def best(self) -> SkillSearch:
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
    """The results at each age."""
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
    progress: Progress = lambda done, total: None,
) -> SkillReport:
    """Search for a skill at some ages, or train a policy for it on a device, and keep the best of each in a folder.

    What is in the folder *out* already from the same software is not searched again.

    Args:
        skill: One of `mimoc.schema.kinds.SKILLS`.
        ages: In [months], in any order.
        out: The folder of the results.
        spec: The child; None means the average one.
        options: Keys of the task, such as `style`.
        seeds: Number of searches at each age, or of trainings.
        tries: Movements that each search tries at most.
        starts: Number of starts in which each result is measured.
        processes: How many searches, or measurements of policies, run side by side.
        device: `cpu` for searches, or where `mimoc.train` trains policies instead, in *envs* infants for *steps*.
        steps: Control steps of a training.
        envs: Infants of a training.
        progress: Called with how many searches, or control steps, are done, and with their total.

    Raises:
        SpecError: If the task does not have these options.
        OutputError: If the folder cannot be written.
    """
    child = spec or InfantSpec.model_validate(CHILD)
    task = {"kind": skill, **(options or {})}
    infants = {age: child.with_(task=None).with_(age_months=age, task=task, scene=None) for age in sorted(ages)}
    jobs = [(infant, seed) for infant in infants.values() for seed in range(seeds)]
    if device == "cpu":
        what = ("searched", tries, starts)
        make = partial(searches, tries=tries, starts=starts, processes=processes)
    else:
        what = ("trained", steps, starts, device, envs)
        make = partial(trainings, steps=steps, starts=starts, device=device, envs=envs, out=out, processes=processes)

    def attempt(places: Sequence[int]) -> Iterator[tuple[int, SkillSearch]]:
        make_folder(out, below=out.parent)
        return make([jobs[place] for place in places], progress)

    keys = [(*what, infant.model_dump(mode="json"), seed) for infant, seed in jobs]
    attempts = JobStore(out, "attempts", SkillSearch).complete(keys, attempt)
    results = [AgeResult.of([attempt for attempt in attempts if attempt.age_months == float(age)]) for age in infants]
    for result in results:
        best, name = result.best, f"{skill}_{result.age_months:g}_months"
        if best.movement:
            write_postures(best.movement, out / f"{name}.json")
        elif best.policy:
            write_file(out / f"{name}.zip", (out / best.policy).read_bytes())
    return SkillReport.of(skill, results, bodies_of(child, ages))


RESULTS = Path(__file__).with_name("results")
"""What is known of each skill that was searched for or trained; `.ci/task skills` renews what was searched for."""


@dataclass(frozen=True)
class SkillsReport:
    """All skills whose results come with mimoc, and those that wait for a GPU."""

    skills: Sequence[SkillReport]

    @property
    def waiting(self) -> list[str]:
        """Skills without results."""
        return [name for name in SKILLS if name not in {skill.skill for skill in self.skills}]

    @property
    def passed(self) -> bool:
        """Whether no skill comes too early; one that a search does not find says little."""
        return all(skill.verdict != "too early" for skill in self.skills)

    @property
    def rows(self) -> list[AgeRow]:
        """The skills as they are plotted."""
        what = "mimoc, half of the starts"
        return [
            AgeRow(item.skill.replace("_", " "), {what: item.from_months}, item.real_infants.ages)
            for item in self.skills
        ]

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data."""
        skills = [skill.to_data() for skill in self.skills]
        return {"passed": self.passed, "skills": skills, "waiting": self.waiting}


def shipped_skills(folder: Path = RESULTS) -> SkillsReport:
    """Return all results that come with mimoc, in the order in which infants learn skills; or raise a MimocError."""
    read = {name: read_json_file(folder / f"{name}.json", SkillReport) for name in SKILLS}
    skills = [skill for skill in read.values() if skill is not None]
    if not skills:
        raise MimocError(f"{folder}: no results of skills; `.ci/task skills` makes them")
    return SkillsReport(skills)


SUCCESS = Quantity("success_rate", "Success", "1")


def skill_sheet(report: SkillReport) -> Sheet:
    """Return success by age with its intervals, each search as a dot, over the ages of real infants."""
    ages = [result.age_months for result in report.ages]
    low, high = zip(*(result.interval for result in report.ages), strict=True)
    real = report.real_infants
    window = real.youngest_months, real.oldest_months
    searches = [(result.age_months, attempt.success) for result in report.ages for attempt in result.searches]
    plot = Plot(
        x=AGE,
        y=SUCCESS,
        lines=(
            Line(ages, [result.success for result in report.ages], "all searches"),
            *(Line((age,) * 2, (0.0, 1.0), "", "median") for age in real.ages[1:-1]),
        ),
        bands=(
            Band(window, (0.0, 0.0), (1.0, 1.0), "real infants (line: usual)", "window"),
            Band(ages, low, high, "95 %"),
        ),
        dots=(Dots([age for age, _ in searches], [share for _, share in searches], "each search"),),
        title=f"{report.skill.replace('_', ' ')}: share of starts with success",
        x_range=(min([*ages, real.youngest_months]) - 0.5, max([*ages, real.oldest_months]) + 0.5),
        y_range=(-0.03, 1.03),
        level=LEARNT,
    )
    return Sheet((plot,))
