"""Motor milestones: from which age on an infant can do what real infants learn to do, with each of its sides."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from mimoc.base.classes import takes
from mimoc.base.rounding import rounded
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.variants import at_age, errors_at
from mimoc.schema.counterparts import counterpart, exchanged, has_like_sides
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import SIDES
from mimoc.studies.comparison import GOOD, AgeRange, Verdict, read_figures
from mimoc.studies.growth_plots import AgeRow
from mimoc.studies.jobs import Progress
from mimoc.studies.milestones.search import SearchResult, ages_of, search_trials
from mimoc.studies.milestones.trial import USUAL, Conditions, Trial
from mimoc.studies.milestones.trials import FURTHER, TRIALS

WINDOWS: Mapping[str, AgeRange] = dict(read_figures(Path(__file__).with_name("windows.csv"), AgeRange))
"""When real infants reach milestones, by the name of the trial."""


@dataclass(frozen=True)
class Milestone:
    """The results of one trial."""

    trial: Trial
    sides: Mapping[str, SearchResult]
    """Results by side, `left` and `right`, or by an empty name if the trial has no sides."""
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
        """The result of the worse side."""
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
    """Reports on its counterparts by their names, such as `healthy`."""

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
        conditions: Under which conditions it tries; None means with delays and noise of its senses and commands.
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
            child_of(at_age(infant, age_months, checked=False))
    usual = conditions or USUAL
    further = {trial.name for trial in FURTHER}

    def report(child: InfantSpec) -> MilestoneReport:
        asked = {name: _searches(TRIALS[name], child) for name in names}
        searches = [one for by_side in asked.values() for one in by_side.values()]
        results = search_trials(child, usual, searches, ages or ages_of(child), processes, progress)
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
    return {"left": right.model_copy(update={"outcomes": mirrored}), "right": right}
