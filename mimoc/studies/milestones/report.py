"""Milestones of an infant, of each side where there are two, beside those of real infants."""

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from mimoc.base.classes import takes
from mimoc.base.rounding import rounded
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.variants import at_age_unchecked, errors_at
from mimoc.schema.base import Model
from mimoc.schema.counterparts import counterpart, exchanged, has_like_sides
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import SIDES
from mimoc.studies.certainty import ASSUMPTION, Certainty
from mimoc.studies.growth.plot import AgeRow
from mimoc.studies.milestones.infant import Conditions
from mimoc.studies.milestones.search import Progress, SearchResult, ages_of, search
from mimoc.studies.milestones.trial import Trial
from mimoc.studies.milestones.trials import FURTHER, TRIALS

Verdict = Literal["inside", "too early", "too late", "not reached", "no verdict"]
GOOD: tuple[Verdict, ...] = ("inside", "no verdict")


class AgeRange(Model):
    """Ages at which infants reach a milestone, in months."""

    youngest_months: float
    oldest_months: float
    usual_months: float | None
    """The mean, or the age that a source gives; None if it gives none."""
    sd_months: float | None = None
    """Standard deviation of the ages of infants; None if the source gives none."""
    span: str
    """What these ages are, such as percentiles."""
    source: str
    certainty: Certainty

    @property
    def ages(self) -> tuple[float, ...]:
        """Youngest, usual and oldest age."""
        usual = () if self.usual_months is None else (self.usual_months,)
        return (self.youngest_months, *usual, self.oldest_months)

    def window(self, *, of_average: bool) -> tuple[float, float]:
        """Return the ages that a child is judged by, youngest and oldest.

        An average child is judged by the mean ± 1 SD where both are known, since nearly any age is within the 1st and
        99th percentile; others are judged by the whole range.
        """
        if of_average and self.usual_months is not None and self.sd_months is not None:
            return rounded(self.usual_months - self.sd_months), rounded(self.usual_months + self.sd_months)
        return self.youngest_months, self.oldest_months

    def verdict(self, age_months: float | None, *, of_average: bool = False) -> Verdict:
        """Return how the age at which an infant reaches it compares; None is never. Nobody is judged by assumptions."""
        youngest_months, oldest_months = self.window(of_average=of_average)
        if self.certainty == ASSUMPTION:
            return "no verdict"
        if age_months is None:
            return "not reached"
        if age_months < youngest_months:
            return "too early"
        return "inside" if age_months <= oldest_months else "too late"


def read_age_ranges(path: Path) -> dict[str, AgeRange]:
    """Return the rows of a table of ages by what stands in its first column."""
    with path.open(encoding="utf-8", newline="") as file:
        _, *rest = next(lines := csv.reader(file))
        return {
            name: AgeRange.model_validate({key: cell or None for key, cell in zip(rest, cells, strict=True)})
            for name, *cells in lines
        }


WINDOWS: Mapping[str, AgeRange] = read_age_ranges(Path(__file__).with_name("windows.csv"))  # By name of the trial.


@dataclass(frozen=True)
class Milestone:
    """What was found for one trial."""

    trial: Trial
    sides: Mapping[str, SearchResult]  # By side, `left` and `right`; of a trial without sides, by an empty name.
    window: AgeRange | None  # When real infants reach it, if that is known.
    judged: bool  # Whether it is compared with real infants, or only reported.
    months_early: float = 0.0  # How long before term the child was born, by which its ages are corrected.
    of_average: bool = False
    """Whether the child is average, so that it is judged by the mean ± 1 SD of real infants where that is known."""

    @property
    def side(self) -> str:
        """The worse side, if they differ: one that is outside the window, or else the later one."""
        differ = len({result.youngest_months for result in self.sides.values()}) > 1
        return max(self.sides, key=self._badness) if differ else ""

    @property
    def result(self) -> SearchResult:
        """What was found for the worse side."""
        return self.sides[self.side or next(iter(self.sides))]

    @property
    def verdict(self) -> Verdict:
        """How the infant compares with real ones, by its worse side."""
        return self.verdict_of(self.result)

    @property
    def failed(self) -> bool:
        """Whether a side is outside the window."""
        return self.verdict not in GOOD

    def verdict_of(self, result: SearchResult) -> Verdict:
        """Return how what was found for a side compares with real infants."""
        if not self.judged or self.window is None:
            return "no verdict"
        age_months = result.youngest_months
        corrected_months = None if age_months is None else age_months - self.months_early
        return self.window.verdict(corrected_months, of_average=self.of_average)

    @property
    def plotted_months(self) -> tuple[float, ...]:
        """Youngest, usual and oldest age of real infants by which it is judged, as they are plotted."""
        if self.window is None or self.judged_by is None:
            return ()
        _, *usual, _ = self.window.ages
        return (self.judged_by[0], *usual, self.judged_by[1])

    @property
    def judged_by(self) -> tuple[float, float] | None:
        """The youngest and the oldest age that are inside; None if no ages of real infants are known."""
        return self.window.window(of_average=self.of_average) if self.window else None

    def to_data(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return {
            "name": self.trial.name,
            "title": self.trial.title,
            "basis": self.trial.basis,
            **self._data_of(self.result),
            "worse_side": self.side or None,
            "sides": {side: self._data_of(result) for side, result in self.sides.items() if side},
            "window": self.window.model_dump() if self.window else None,
            "judged_by_months": self.judged_by,
        }

    def _badness(self, side: str) -> tuple[bool, float]:
        age_months = self.sides[side].youngest_months
        return self.verdict_of(self.sides[side]) not in GOOD, math.inf if age_months is None else age_months

    def _data_of(self, result: SearchResult) -> dict[str, Any]:
        return {
            "youngest_months": result.youngest_months,
            "at_birth": result.at_birth,
            "verdict": self.verdict_of(result),
            "tried": [{"age_months": age, **asdict(outcome)} for age, outcome in result.outcomes.items()],
        }


@dataclass(frozen=True)
class MilestoneReport:
    """The milestones of an infant."""

    development: str  # The law that it follows.
    actuation: str  # Its actuation model.
    conditions: Conditions
    milestones: Sequence[Milestone]
    beside: Mapping[str, "MilestoneReport"] = field(default_factory=dict)
    """Those of its counterparts, by what they are, such as `healthy`."""

    @property
    def passed(self) -> bool:
        """Whether every milestone that is judged is inside its window, on both sides."""
        return not any(milestone.failed for milestone in self.milestones)

    @property
    def rows(self) -> list[AgeRow]:
        """The milestones as they are plotted; of those with sides the worse one."""
        reports = {"mimoc, from this age on": self, **{f"the {name} child": it for name, it in self.beside.items()}}
        return [
            AgeRow(
                item.trial.title,
                {label: one.milestones[place].result.youngest_months for label, one in reports.items()},
                item.plotted_months,
            )
            for place, item in enumerate(self.milestones)
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
                "beside": {name: report.to_data() for name, report in self.beside.items()},
            }
        )


@takes("a spec, or None", InfantSpec, type(None))
def validate_milestones(
    spec: InfantSpec | None = None,
    conditions: Conditions | None = None,
    *,
    names: Sequence[str] = tuple(TRIALS),
    ages: Sequence[float] | None = None,
    processes: int = 1,
    progress: Progress | None = None,
    beside: str | None = None,
) -> MilestoneReport:
    """Return at what age an infant reaches each motor milestone, with each of its sides, beside real infants.

    Args:
        spec: The infant, grown to each age; None means the average child. Its own age, scene and task are not used.
        conditions: Under which conditions it tries; None means the usual ones.
        names: The trials, of `TRIALS`.
        ages: Ages to try, in months; None means every half month from birth, or term, to two years. A child that was
            born early is judged by its corrected age.
        processes: Number of processes. With more than one, a script must guard its main part by
            `if __name__ == "__main__"`.
        progress: Called with the number of ages done with and their total, for each child anew.
        beside: `healthy` lets the same child without what impairs it try as well.

    Raises:
        SpecError: If the spec asks for what this version cannot build, or for a child that there is not at some age.
        MimocError: If nothing impairs the child that is to stand beside a healthy one.

    Example:
        >>> import mimoc
        >>> report = mimoc.validate_milestones(names=["no_head_lag"], ages=[0, 18])
        >>> [tried["success"] for tried in report.to_data()["milestones"][0]["tried"]]
        [False, True]
    """
    infant = checked_or_average(spec)
    others = {beside: counterpart(infant, beside)} if beside else {}
    for age_months in ages or ages_of(infant):  # Before minutes of trials.
        with errors_at(infant, age_months):
            child_of(at_age_unchecked(infant, age_months))
    usual, further = conditions or Conditions(), {trial.name for trial in FURTHER}

    def report(child: InfantSpec) -> MilestoneReport:
        asked = {name: _searches(TRIALS[name], child) for name in names}
        searches = [one for by_side in asked.values() for one in by_side.values()]
        results = search(child, usual, searches, ages or ages_of(child), processes, progress)
        milestones = [
            Milestone(
                TRIALS[name],
                _both({side: results[one] for side, one in by_side.items()}),
                WINDOWS.get(name),
                name not in further,
                child.months_early,
                is_average(child),
            )
            for name, by_side in asked.items()
        ]
        return MilestoneReport(child.development, child.actuation.model, usual, milestones)

    return replace(report(infant), beside={name: report(other) for name, other in others.items()})


def is_average(spec: InfantSpec) -> bool:
    """Return whether a child differs from the average one in nothing that a spec can say of body and strength."""
    body, actuation = spec.body, spec.actuation
    own = body.individual, body.measurements, body.parts, body.remove, body.extra, spec.impairments, actuation.strength
    return not any(own) and actuation.strength_age_months is None


def _searches(trial: Trial, infant: InfantSpec) -> Mapping[str, str]:
    """Return the names of a trial's searches by side; only the right one where the left mirrors it."""
    if not trial.sided:
        return {"": trial.name}
    return {side: f"{trial.name}:{side}" for side in (SIDES[1:] if has_like_sides(infant) else SIDES)}


def _both(results: Mapping[str, SearchResult]) -> Mapping[str, SearchResult]:
    if set(results) != {"right"}:
        return results
    right = results["right"]
    mirrored = {
        age: replace(outcome, reason=exchanged(outcome.reason), strategy=exchanged(outcome.strategy))
        for age, outcome in right.outcomes.items()
    }
    return {"left": replace(right, outcomes=mirrored), "right": right}
