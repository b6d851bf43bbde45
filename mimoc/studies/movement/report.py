"""How an infant moves beside how real infants move, by trial, measure and age."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from mimoc.base.classes import takes
from mimoc.base.errors import UnknownNameError
from mimoc.base.quantities import Quantity
from mimoc.base.rounding import rounded
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.variants import at_age_unchecked, errors_at
from mimoc.render.plots.windows import Panel
from mimoc.schema.base import Model
from mimoc.schema.counterparts import counterpart, exchanged, has_like_sides
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import SIDES
from mimoc.studies.certainty import ASSUMPTION, READ, Basis, Certainty
from mimoc.studies.kept_results import process_pool
from mimoc.studies.milestones.infant import Conditions, compile_once, grown_to
from mimoc.studies.milestones.search import Progress
from mimoc.studies.movement.trial import Subject, Values, missing
from mimoc.studies.movement.trials import TRIALS, USUAL

Verdict = Literal["inside", "outside", "not reached", "no verdict", "not tried"]


class Window(Model):
    """Values that real infants have at some ages."""

    youngest_months: float
    oldest_months: float
    low: float | None
    """None if there is no lower end, as for `high`."""
    high: float | None
    used: Basis
    """Whether a number of the law `maturing` is chosen for this figure, or none is, so that it is predicted."""
    certainty: Certainty
    source: str

    def holds_at(self, age_months: float) -> bool:
        """Return whether it is about infants of some age."""
        return self.youngest_months <= age_months <= self.oldest_months

    @property
    def is_read_direction(self) -> bool:
        """Whether it is a fact that was read, and says which way a value has to go: it has one end."""
        return self.certainty in READ and (self.low is None) != (self.high is None)

    def has(self, value: float) -> bool:
        """Return whether a value is inside."""
        return (self.low is None or value >= self.low) and (self.high is None or value <= self.high)

    def error(self, value: float) -> float:
        """Return how far a value is below the lower end, as a number below 0, or above the upper one; 0 inside."""
        end = self.low if self.low is not None and value < self.low else self.high
        return 0.0 if self.has(value) or end is None else value - end


def _windows() -> Iterator[tuple[str, Window]]:
    with Path(__file__).with_name("windows.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            name = row.pop("measure")
            yield name, Window.model_validate({key: value or None for key, value in row.items()})


WINDOWS: Sequence[tuple[str, Window]] = tuple(_windows())
"""Each with the name of its measure, of which there can be several by age; the younger comes first."""


def window_of(measure: str, age_months: float) -> Window | None:
    """Return what is asked of a measure at some age; None if nothing is."""
    return next((window for name, window in WINDOWS if name == measure and window.holds_at(age_months)), None)


@dataclass(frozen=True, slots=True)
class Row:
    """A measure of an infant of some age."""

    trial: str
    measure: Quantity
    age_months: float
    value: float | None
    """None if it was not tried, or did not happen, such as the time to a bend of the hip that it does not reach."""
    window: Window | None
    reason: str = ""  # Why it was not tried.
    side: str = ""  # `left`, `right`, or `both` of an infant whose sides are alike; none if the measure has no side.

    @property
    def name(self) -> str:
        """Name of the measure, with the side of an infant whose sides are not alike: `kick_deg, left`."""
        return self.named(self.measure.name)

    def named(self, measure: str) -> str:
        """Return a name of the measure with this side."""
        return f"{measure}, {self.side}" if self.side in SIDES else measure

    @property
    def verdict(self) -> Verdict:
        """How the infant compares with real ones."""
        if self.reason:
            return "not tried"
        if self.window is None or self.window.certainty == ASSUMPTION:
            return "no verdict"
        if self.value is None:
            return "not reached"
        return "inside" if self.window.has(self.value) else "outside"

    @property
    def error(self) -> float | None:
        """How far it is below (below 0) or above its window, in its unit; None if there is no value to judge."""
        if self.window is None or self.value is None or self.verdict not in ("inside", "outside"):
            return None
        return self.window.error(self.value)

    @property
    def failed(self) -> bool:
        """Whether it is outside a window that is no assumption."""
        return self.verdict in ("outside", "not reached")

    def to_data(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return {
            "trial": self.trial,
            "measure": self.measure.name,
            "unit": self.measure.unit,
            "age_months": self.age_months,
            "side": self.side or None,
            "value": self.value,
            "verdict": self.verdict,
            "held_out": TRIALS[self.trial].held_out,
            "error": self.error,
            "window": self.window.model_dump() if self.window else None,
            "reason": self.reason,
        }


@dataclass(frozen=True)
class MovementReport:
    """How an infant moves."""

    development: str  # The law that it follows.
    actuation: str  # Its actuation model.
    rows: Sequence[Row]
    beside: Mapping[str, "MovementReport"] = field(default_factory=dict)
    """Those of its counterparts, by what they are, such as `healthy`."""

    @property
    def passed(self) -> bool:
        """Whether nothing is outside a window that is no assumption."""
        return not any(row.failed for row in self.rows)

    @property
    def held_out(self) -> Sequence[Row]:
        """The predictions that count: rows with a verdict of the trials by which nothing of the law was chosen.

        Only those about facts that were read and have a direction: nearly any value is inside two SD either way.
        """
        judged = (row for row in self.rows if row.verdict in ("inside", "outside", "not reached"))
        return [row for row in judged if TRIALS[row.trial].held_out and row.window and row.window.is_read_direction]

    @property
    def by_measure(self) -> Mapping[str, Sequence[Row]]:
        """The rows of each measure, by `Row.name`, the youngest first."""
        names = dict.fromkeys(row.name for row in self.rows)
        return {name: [row for row in self.rows if row.name == name] for name in names}

    @property
    def titles(self) -> Mapping[str, str]:
        """What is done in each trial, by its name."""
        return {name: TRIALS[name].title for name in dict.fromkeys(row.trial for row in self.rows)}

    @property
    def panels(self) -> list[Panel]:
        """The measures as they are plotted, without windows that are assumptions."""
        return [
            Panel(
                replace(rows[0].measure, label=rows[0].named(rows[0].measure.label)),
                [(row.age_months, row.value) for row in rows if row.value is not None],
                [
                    (window.youngest_months, window.oldest_months, window.low, window.high)
                    for name, window in WINDOWS
                    if name == rows[0].measure.name and window.certainty != ASSUMPTION
                ],
            )
            for rows in self.by_measure.values()
        ]

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data, numbers rounded as in files."""
        return rounded(
            {
                "development": self.development,
                "actuation": self.actuation,
                "passed": self.passed,
                "trials": self.titles,
                "held_out": {"inside": sum(not row.failed for row in self.held_out), "tried": len(self.held_out)},
                "rows": [row.to_data() for row in self.rows],
                "beside": {name: report.to_data() for name, report in self.beside.items()},
            }
        )


@takes("a spec, or None", InfantSpec, type(None))
def validate_movement(
    spec: InfantSpec | None = None,
    *,
    names: Sequence[str] = USUAL,
    ages: Sequence[float] | None = None,
    processes: int = 1,
    progress: Progress | None = None,
    beside: str | None = None,
) -> MovementReport:
    """Return how an infant kicks, swings, lifts, folds, looks and grips, beside real infants.

    Args:
        spec: The infant, grown to each age; None means the average child. Its own age, scene and task are not used.
        names: The trials, of `mimoc.studies.movement.TRIALS`; those that take minutes are done only if they are named.
        ages: Ages to try, in months; None means those of each trial, at which there are figures of real infants.
        processes: Number of processes. With more than one, a script must guard its main part by
            `if __name__ == "__main__"`.
        progress: Called with the number of trials done, an age each, and their total, for each child anew.
        beside: `healthy` lets the same child without what impairs it do the same.

    Raises:
        UnknownNameError: If there is no trial of some name.
        SpecError: If the spec asks for what this version cannot build, or for a child that there is not at some age.
        MimocError: If nothing impairs the child that is to stand beside a healthy one.

    Example:
        >>> import mimoc
        >>> report = mimoc.validate_movement(names=["damping"], ages=[0])
        >>> [row.verdict for row in report.rows if row.measure.name == "damping_hip"]
        ['inside']
    """
    for name in names:
        if name not in TRIALS:
            raise UnknownNameError("trial", name, list(TRIALS))
    infant = checked_or_average(spec)
    others = {beside: counterpart(infant, beside)} if beside else {}
    jobs = [(name, float(age)) for name in names for age in ages or TRIALS[name].ages_months]
    for age_months in dict.fromkeys(age for _, age in jobs):
        with errors_at(infant, age_months):
            child_of(at_age_unchecked(infant, age_months))
    shown = progress or (lambda done, total: None)
    one, *rest = (_report(child, jobs, processes, shown) for child in (infant, *others.values()))
    return replace(one, beside=dict(zip(others, rest, strict=True)))


def _report(
    infant: InfantSpec, jobs: Sequence[tuple[str, float]], processes: int, progress: Progress
) -> MovementReport:
    sides = BOTH if has_like_sides(infant) else SIDES
    sided = [(*job, side) for job in jobs for side in (sides if TRIALS[job[0]].side else ("",))]
    results = _run(infant.model_dump_json(), sided, processes, progress)
    rows = list[Row]()
    for (name, age, side), result in ((job, results[job]) for job in sided):
        for measure in TRIALS[name].measures:
            window, value = window_of(measure.name, age), result.values.get(measure.name)
            rows.append(Row(name, measure, age, value, window, result.reason, side))
    return MovementReport(infant.development, infant.actuation.model, rows)


BOTH = ("both",)
Job = tuple[str, float, str]  # Name of a trial, age in months, and the side whose limb is measured.


@dataclass(frozen=True, slots=True)
class Result:
    """What came of a trial."""

    values: Values
    reason: str = ""  # Why it was not tried.


def _run(spec: str, jobs: Sequence[Job], processes: int, progress: Progress) -> Mapping[Job, Result]:
    """Return what comes of each job; with one process, everything runs in this one."""
    results: dict[Job, Result] = {}
    if processes == 1:
        for job in jobs:
            results[job] = try_movement(spec, *job)
            progress(len(results), len(jobs))
        return results
    with process_pool(processes) as pool:
        running = {pool.submit(try_movement, spec, *job): job for job in jobs}
        for future in as_completed(running):
            results[running[future]] = future.result()
            progress(len(results), len(jobs))
    return results


def try_movement(spec: str, name: str, age_months: float, side: str = "") -> Result:
    """Return what comes of a trial with the infant of a spec in JSON, grown to some age.

    The side that a trial does not measure is measured on the infant's mirror image.
    """
    trial = TRIALS[name]
    mirrored = side in SIDES and side != trial.side
    subject = _subject(exchanged(spec) if mirrored else spec, age_months)
    reason = missing(trial, subject.infant)
    return Result({}, exchanged(reason) if mirrored else reason) if reason else Result(trial.measure(subject))


@lru_cache(maxsize=16)
def _subject(spec: str, age_months: float) -> Subject:
    grown = grown_to(InfantSpec.model_validate_json(spec), age_months, Conditions())
    return Subject(compile_once(spec, age_months, Conditions()), grown)
