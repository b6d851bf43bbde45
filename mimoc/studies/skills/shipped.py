"""When infants can do what was searched for and comes with mimoc, beside real infants."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.bundle.regular_files import read_json_file
from mimoc.render.plots.growth import AgeRow
from mimoc.schema.base import Model
from mimoc.studies.milestones.report import AgeRange, Verdict
from mimoc.tasks import SKILLS

RESULTS = Path(__file__).with_name("results")
"""What `mimoc skill` wrote of each skill that was searched for; `make skills` renews it."""


class ShippedAge(Model):
    """What came of a skill at an age."""

    age_months: float
    """The age."""
    success: float
    """Share of starts with success, over all searches."""
    interval: tuple[float, float]
    """95 % interval of that."""
    searches: tuple[dict[str, Any], ...]
    """Seed, success and curve of each search."""


class ShippedSkill(Model):
    """What came of a skill, as `results.json` says it."""

    skill: str
    """Its name."""
    from_months: float | None
    """The age from which on half of the starts succeed."""
    verdict: Verdict
    """How that compares with real infants."""
    real_infants: AgeRange
    """When they have the skill."""
    ages: tuple[ShippedAge, ...]
    """What came of it at each age."""


@dataclass(frozen=True)
class SkillsReport:
    """All skills whose results come with mimoc, and those that wait for a GPU."""

    skills: Sequence[ShippedSkill]

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
        return [
            AgeRow(skill.skill.replace("_", " "), {"mimoc, half of the starts": skill.from_months}, _ages(skill))
            for skill in self.skills
        ]

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data."""
        skills = [skill.model_dump(mode="json") for skill in self.skills]
        return {"passed": self.passed, "skills": skills, "waiting": self.waiting}


def _ages(skill: ShippedSkill) -> tuple[float, ...]:
    real = skill.real_infants
    return real.youngest_months, real.median_months, real.oldest_months


def shipped_skills(folder: Path = RESULTS) -> SkillsReport:
    """Return all results that come with mimoc, in the order in which infants learn the skills.

    Raises:
        MimocError: If there are none.
    """
    read = {name: read_json_file(folder / f"{name}.json", ShippedSkill) for name in SKILLS}
    skills = [skill for skill in read.values() if skill is not None]
    if not skills:
        raise MimocError(f"{folder}: no results of skills; `make skills` makes them")
    return SkillsReport(skills)
