"""Movement: whether an infant kicks, swings, lifts, folds, looks, grips and steps as real infants do."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from mimoc.base.classes import takes
from mimoc.base.errors import UnknownNameError
from mimoc.base.quantities import Quantity
from mimoc.base.rounding import rounded
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.variants import at_age, errors_at
from mimoc.render.plots import Panel
from mimoc.schema.counterparts import counterpart, exchanged, has_like_sides
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import SIDES
from mimoc.studies.comparison import ASSUMPTION, Reference, Verdict, read_figures
from mimoc.studies.jobs import Progress, run_jobs
from mimoc.studies.milestones.trial import Conditions, compile_once, grown_to
from mimoc.studies.movement.arms import ARM_LIFT, ARM_PULL, REACH, SACCADE
from mimoc.studies.movement.grip import GRIP
from mimoc.studies.movement.kicks import KICK, LEG_WEIGHT, POSTURE, STEPPING
from mimoc.studies.movement.posture import AWAKE, DAMPING, FOLD, PENDULUM, RECOIL, REST, SPEEDS
from mimoc.studies.movement.roll import ROLL
from mimoc.studies.movement.trial import MovementTrial, Subject, Values, missing

TRIALS: Mapping[str, MovementTrial] = {
    trial.name: trial
    for trial in (
        *(KICK, PENDULUM, DAMPING, RECOIL, ARM_LIFT, FOLD, REST, AWAKE, SACCADE, GRIP),
        *(STEPPING, LEG_WEIGHT, POSTURE, ARM_PULL, SPEEDS, REACH, ROLL),
    )
}
USUAL: tuple[str, ...] = tuple(trial.name for trial in TRIALS.values() if not trial.on_request)

WINDOWS: Sequence[tuple[str, Reference]] = tuple(read_figures(Path(__file__).with_name("windows.csv"), Reference))
"""Each with the name of its measure, of which there can be several by age; the younger comes first."""


def window_of(measure: str, age_months: float) -> Reference | None:
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
    window: Reference | None
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
    """Reports on its counterparts by their names, such as `healthy`."""

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
        """Titles of the trials by their names."""
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
        names: The trials, of `TRIALS`; those that take minutes are done only if named.
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
            child_of(at_age(infant, age_months, checked=False))
    shown = progress or (lambda done, total: None)
    one, *rest = (_report(child, jobs, processes, shown) for child in (infant, *others.values()))
    return replace(one, beside=dict(zip(others, rest, strict=True)))


def _report(
    infant: InfantSpec, jobs: Sequence[tuple[str, float]], processes: int, progress: Progress
) -> MovementReport:
    sides = BOTH if has_like_sides(infant) else SIDES
    sided = [(*job, side) for job in jobs for side in (sides if TRIALS[job[0]].side else ("",))]
    spec = infant.model_dump_json()
    results = dict[Job, Measured]()
    rows = list[Row]()
    for place, result in run_jobs(try_movement, [(spec, *job) for job in sided], processes):
        results[sided[place]] = result
        progress(len(results), len(sided))
    for (name, age, side), result in ((job, results[job]) for job in sided):
        for measure in TRIALS[name].measures:
            window = window_of(measure.name, age)
            value = result.values.get(measure.name)
            rows.append(Row(name, measure, age, value, window, result.reason, side))
    return MovementReport(infant.development, infant.actuation.model, rows)


BOTH = ("both",)
Job = tuple[str, float, str]  # Name of a trial, age in months, and the side whose limb is measured.


@dataclass(frozen=True, slots=True)
class Measured:
    """The result of a trial."""

    values: Values
    reason: str = ""  # Why it was not tried.


def try_movement(spec: str, name: str, age_months: float, side: str = "") -> Measured:
    """Return what comes of a trial with the infant of a spec in JSON, grown to some age.

    The side that a trial does not measure is measured on the infant's mirror image.
    """
    trial = TRIALS[name]
    mirrored = side in SIDES and side != trial.side
    subject = _subject(exchanged(spec) if mirrored else spec, age_months)
    reason = missing(trial, subject.infant)
    return Measured({}, exchanged(reason) if mirrored else reason) if reason else Measured(trial.measure(subject))


@lru_cache(maxsize=16)
def _subject(spec: str, age_months: float) -> Subject:
    grown = grown_to(InfantSpec.model_validate_json(spec), age_months, Conditions())
    return Subject(compile_once(spec, age_months, Conditions()), grown)
