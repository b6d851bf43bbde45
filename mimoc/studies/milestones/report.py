"""Milestones of an infant beside those of real infants, and when these reach them."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from mimoc.base.rounding import rounded
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.variants import at_age_unchecked, errors_at
from mimoc.render.plots.growth import AgeRow
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions
from mimoc.studies.milestones.search import AGES, Progress, SearchResult, search
from mimoc.studies.milestones.trial import Trial
from mimoc.studies.milestones.trials import FURTHER, TRIALS

Certainty = Literal["read", "from memory"]
"""Whether the figures were read in the source or its abstract, or are known from memory and not yet checked."""


class AgeRange(Model):
    """Ages at which infants reach a milestone, in months."""

    youngest_months: float
    oldest_months: float
    median_months: float
    span: str
    """What youngest and oldest are, such as percentiles."""
    source: str
    certainty: Certainty

    @property
    def ages(self) -> tuple[float, float, float]:
        """Youngest, median and oldest age, as they are plotted."""
        return self.youngest_months, self.median_months, self.oldest_months

    def verdict(self, age_months: float | None) -> "Verdict":
        """Return how the age at which an infant reaches it compares; None is never."""
        if age_months is None:
            return "not reached"
        if age_months < self.youngest_months:
            return "too early"
        return "inside" if age_months <= self.oldest_months else "too late"


def read_age_ranges(path: Path) -> dict[str, AgeRange]:
    """Return the rows of a table of ages by what stands in its first column."""
    with path.open(encoding="utf-8", newline="") as file:
        table = csv.DictReader(file)
        first = (table.fieldnames or [""])[0]
        return {row.pop(first): AgeRange.model_validate(row) for row in table}


WINDOWS: Mapping[str, AgeRange] = read_age_ranges(Path(__file__).with_name("windows.csv"))
"""By name of the trial. WHO's medians are from memory, the other figures of WHO were read."""


Verdict = Literal["inside", "too early", "too late", "not reached", "no verdict"]


@dataclass(frozen=True)
class Milestone:
    """What was found for one trial."""

    trial: Trial
    result: SearchResult
    window: AgeRange | None
    """When real infants reach it, if that is known."""
    judged: bool
    """Whether it is compared with real infants, or only reported."""

    @property
    def verdict(self) -> Verdict:
        """How the infant compares with real ones."""
        if not self.judged or self.window is None:
            return "no verdict"
        return self.window.verdict(self.result.youngest_months)

    def to_data(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return {
            "name": self.trial.name,
            "title": self.trial.title,
            "youngest_months": self.result.youngest_months,
            "at_birth": self.result.at_birth,
            "verdict": self.verdict,
            "window": self.window.model_dump() if self.window else None,
            "tried": [{"age_months": age, **asdict(outcome)} for age, outcome in self.result.outcomes.items()],
        }


@dataclass(frozen=True)
class MilestoneReport:
    """The milestones of an infant."""

    development: str
    """The law that it follows."""
    actuation: str
    """Its actuation model."""
    conditions: Conditions
    milestones: Sequence[Milestone]

    @property
    def passed(self) -> bool:
        """Whether every milestone that is judged is inside its window."""
        return all(milestone.verdict in ("inside", "no verdict") for milestone in self.milestones)

    @property
    def rows(self) -> list[AgeRow]:
        """The milestones as they are plotted."""
        name = "mimoc, from this age on"
        return [
            AgeRow(item.trial.title, {name: item.result.youngest_months}, item.window.ages if item.window else ())
            for item in self.milestones
        ]

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data, numbers rounded as in files."""
        return rounded(
            {
                "development": self.development,
                "actuation": self.actuation,
                "conditions": asdict(self.conditions),
                "passed": self.passed,
                "milestones": [milestone.to_data() for milestone in self.milestones],
            }
        )


def validate_milestones(
    spec: InfantSpec | None = None,
    conditions: Conditions | None = None,
    *,
    names: Sequence[str] = tuple(TRIALS),
    ages: Sequence[float] | None = None,
    processes: int = 1,
    progress: Progress | None = None,
) -> MilestoneReport:
    """Return at what age an infant reaches each motor milestone, beside real infants.

    Args:
        spec: The infant, grown to each age; None means the average child. Its own age, scene and task are not used.
        conditions: Under which conditions it tries; None means the usual ones.
        names: The trials, of `TRIALS`.
        ages: Ages to try, in months; None means every half month from birth to two years.
        processes: Number of processes. With more than one, a script must guard its main part by
            `if __name__ == "__main__"`.
        progress: Called with the number of ages done with and their total.

    Raises:
        SpecError: If the spec asks for what this version cannot build, or for a child that there is not at some age.

    Example:
        >>> import mimoc
        >>> report = mimoc.validate_milestones(names=["no_head_lag"], ages=[0, 18])
        >>> [tried["success"] for tried in report.to_data()["milestones"][0]["tried"]]
        [False, True]
    """
    infant = checked_or_average(spec)
    for age_months in ages or AGES:  # Before minutes of trials.
        with errors_at(infant, age_months):
            child_of(at_age_unchecked(infant, age_months))
    usual = conditions or Conditions()
    results = search(infant, usual, names, ages or AGES, processes, progress)
    further = {trial.name for trial in FURTHER}
    return MilestoneReport(
        infant.development,
        infant.actuation.model,
        usual,
        [Milestone(TRIALS[name], results[name], WINDOWS.get(name), name not in further) for name in names],
    )
