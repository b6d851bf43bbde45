"""When infants can do what was searched for and comes with mimoc, beside real infants, and the plot of a skill."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import AGE
from mimoc.bundle.regular_files import read_json_file
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Sheet
from mimoc.schema.components.tasks import SKILLS
from mimoc.studies.growth.plot import AgeRow
from mimoc.studies.skills.learning import LEARNT, SkillReport

RESULTS = Path(__file__).with_name("results")
"""What is known of each skill that was searched for or trained; `make skills` renews what was searched for."""


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
        raise MimocError(f"{folder}: no results of skills; `make skills` makes them")
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
