"""Console output of comparisons (growth, measurements, motor milestones) and of cohorts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from statistics import fmean, stdev
from typing import TYPE_CHECKING, Any

from rich.table import Table
from rich.text import Text

from mimoc.base.errors import counted
from mimoc.base.quantities import QUANTITIES, Quantity
from mimoc.base.quantities.child import DIFFERENCE, FROM_AGE, INDICATORS, JOB_SIZE, JOB_TIME, MEAN_AGE, TIME_LEFT
from mimoc.base.rounding import readable
from mimoc.cli.console import new_table, open_console

if TYPE_CHECKING:
    from mimoc.fits.who import Reference
    from mimoc.studies.cohorts import Status
    from mimoc.studies.cohorts.milestones import MilestoneSummary
    from mimoc.studies.cohorts.plan import Plan, StepPlan
    from mimoc.studies.growth.anthrokids import MeasurementReport, MeasurementRow
    from mimoc.studies.growth.who import GrowthReport, Row
    from mimoc.studies.milestones import AgeRange, Milestone, MilestoneReport
    from mimoc.studies.movement import MovementReport, Row as MovementRow, Window

POPULATIONS: Mapping[Reference, str] = {"male": "boys", "female": "girls", "mean": "boys and girls"}
Column = Callable[["Row"], "str | Text"]


def print_growth(report: GrowthReport, requested_sd: float) -> None:
    """Print one table per growth indicator, with a row for each age, and the verdict."""
    console = open_console()
    for indicator, rows in report.by_indicator.items():
        console.print(f"{INDICATORS[indicator].title} against WHO's {POPULATIONS[report.reference]}")
        columns = _growth_columns(rows)
        table = new_table(*columns, left=0, collapse_padding=True, pad_edge=False)
        for row in rows:
            table.add_row(*(column(row) for column in columns.values()))
        console.print(table)
        console.print(_largest_deviation(rows) + "\n")
    goals = {
        "within one SD of the mean of WHO's boys and girls": [row for row in report.rows if row.requested_z is None],
        f"as asked for, within {requested_sd:g} SD": [row for row in report.rows if row.requested_z is not None],
    }
    for goal, rows in goals.items():
        judged = [row for row in rows if row.is_judged]
        failing = sorted({row.indicator for row in judged if row.missed})
        if failing:
            console.print(Text(f"failed: not {goal} at every age: {', '.join(failing)}", style="red"))
        elif judged:
            console.print(Text(f"ok: {goal} at every age: {_names(judged)}", style="green"))
    if reported := [row for row in report.rows if not row.is_judged]:
        console.print(f"follows from other keys of the spec, and is not judged: {_names(reported)}")


def _growth_columns(rows: Sequence[Row]) -> Mapping[str, Column]:
    reference = rows[0].reference
    columns: dict[str, Column] = {"months": lambda row: f"{row.age_months:g}", "infant": lambda row: f"{row.value:.2f}"}
    if reference == "mean":
        columns |= {"z boys": lambda row: f"{row.z['male']:+.2f}", "z girls": lambda row: f"{row.z['female']:+.2f}"}
    columns |= {"z": _z, "percentile": lambda row: f"{row.percentile[reference]:.1f}"}
    if any(row.requested_z is not None for row in rows):
        columns["z asked for"] = lambda row: "" if row.requested_z is None else f"{row.requested_z:+.2f}"
    if any(row.missed for row in rows):
        columns["verdict"] = lambda row: "missed" if row.missed else ""
    return columns


def _z(row: Row) -> Text:
    """Return a z-score as text, in yellow and with a star if it is missed."""
    return Text(f"{row.z[row.reference]:+.2f}{'*' if row.missed else ' '}", style="yellow" if row.missed else "")


def _largest_deviation(rows: Sequence[Row]) -> str:
    row = max(rows, key=lambda row: abs(row.deviation))
    what = "what is asked for" if row.requested_z is not None else "the median"
    deviation = round(row.deviation, 2) + 0.0  # Which turns -0.0 into 0.
    return f"largest deviation from {what}: {deviation:+.2f} SD at {row.age_months:g} months"


def _names(rows: Sequence[Row]) -> str:
    return ", ".join(dict.fromkeys(INDICATORS[row.indicator].label.lower() for row in rows))


def print_measurements(report: MeasurementReport, tolerance: float) -> None:
    """Print one row for each measurement, with its deviation in each age group, the largest of all, and the verdict."""
    console = open_console()
    is_average = all(row.requested == 1 for row in report.rows)
    goal = "AnthroKids' means" + ("" if is_average else ", as scaled by the spec,")
    console.print(f"{DIFFERENCE.heading} from {goal.removesuffix(',')}")
    table = new_table("months", *(f"{age_months:g}" for age_months in report.ages_months), padding=0)
    for name, rows in report.by_measurement():
        cells = (_deviation(rows[age]) if age in rows else Text("") for age in report.ages_months)
        table.add_row(name.replace("_", " "), *cells)
    console.print(table)
    worst = max((row for row in report.rows if row.is_judged), key=lambda row: abs(row.deviation))
    console.print(
        f"largest: {worst.measurement.replace('_', ' ')} at {worst.age_months:g} months, {worst.value_cm:.2f} cm "
        f"({100 * worst.deviation:+.1f} %)"
    )
    verdict = f"within {100 * tolerance:g} % of {goal} in every age group"
    if failing := [name for name, rows in report.by_measurement() if any(row.outside for row in rows.values())]:
        console.print(Text(f"failed: not {verdict}: {', '.join(failing)}", style="red"))
    else:
        console.print(Text(f"ok: {verdict}", style="green"))
    if reported := dict.fromkeys(row.measurement.replace("_", " ") for row in report.rows if not row.is_judged):
        console.print(f"in brackets: changed by other keys of the spec, and not judged: {', '.join(reported)}")


def _deviation(row: MeasurementRow) -> Text:
    """Return a deviation as text, in yellow and with a star if it is too large, in brackets if it is not judged."""
    text = f"{100 * row.deviation:+.1f}"
    if not row.is_judged:
        return Text(f"({text})")
    return Text(f"{text}{'*' if row.outside else ' '}", style="yellow" if row.outside else "")


def print_milestones(report: MilestoneReport) -> None:
    """Print a row for each milestone, the sources, and the verdict."""
    out = open_console()
    out.print(f"motor milestones, development {report.development}, {report.actuation} actuation")
    healthy = [other.milestones for other in report.beside.values()]
    headings = (FROM_AGE.heading, *report.beside, "real infants", "usual", "verdict", "age")
    table = new_table("milestone", *headings, padding=0)
    for milestone, *others in zip(report.milestones, *healthy, strict=True):
        for row in _milestone_rows(milestone, others):
            table.add_row(*row)
    out.print(table)
    for milestone in report.milestones:
        trial = milestone.trial
        out.print(f"{trial.name}: {trial.title}{_source(milestone.window)}")
    out.print("from: the youngest age at which, and at all older ages tried, the infant succeeds")
    if any(item.of_average and item.window and item.window.sd_months for item in report.milestones):
        out.print("real infants: of WHO's milestones, mean ± 1 SD, since this is the average child")
    if early := report.milestones[0].months_early if report.milestones else 0.0:
        out.print(
            f"born {early:.1f} months early: ages are since birth, and judged by the corrected age, {early:.1f} less"
        )
    out.print("age: fitted if a number of the law was chosen to reproduce it, which the verdict says; else predicted")
    if failing := [f"{item.trial.name} {item.side}".rstrip() for item in report.milestones if item.failed]:
        out.print(Text(f"failed: outside the window of real infants: {', '.join(failing)}", style="red"))
    else:
        out.print(Text("ok: every milestone is inside the window of real infants", style="green"))


def _milestone_rows(milestone: Milestone, others: Sequence[Milestone]) -> Iterator[tuple[str | Text, ...]]:
    window, infants = milestone.window, (milestone, *others)
    sides = milestone.sides if any(infant.side for infant in infants) else [next(iter(milestone.sides))]
    for side in sides:
        results = [infant.sides[side] for infant in infants]
        verdict = milestone.verdict_of(results[0])
        yield (
            f"{milestone.trial.name}{f', {side}' if len(sides) > 1 else ''}",
            *(_from_months(result.youngest_months) for result in results),
            "{:g}-{:g}".format(*milestone.judged_by) if milestone.judged_by else "",
            "" if window is None or window.usual_months is None else f"{window.usual_months:g}",
            Text(verdict, style={"inside": "green", "no verdict": ""}.get(verdict, "red")),
            milestone.trial.basis,
        )


def _from_months(age_months: float | None) -> str:
    return "never" if age_months is None else "birth" if age_months == 0 else f"{age_months:g}"


def _source(window: AgeRange | None) -> str:
    return f"; {window.span}: {window.source} ({window.certainty})" if window else ""


def print_milestone_summary(summary: MilestoneSummary) -> None:
    """Print the ages at which the children of a cohort reach milestones, and the odds of being late, with sources."""
    out = open_console()
    headings = ("n", "not by 24", MEAN_AGE.heading, "SD", "WHO's mean", "WHO's SD", "WHO's milestone")
    table = new_table("milestone", *headings, title="ages of milestones")
    for row in summary.spreads:
        who = row.who_mean_months, row.who_sd_months
        table.add_row(
            row.trial, f"{row.n}", f"{row.not_reached}", *map(_months, (row.mean_months, row.sd_months, *who)), row.who
        )
    out.print(table)
    out.print(f"WHO: {summary.who_source}")
    if summary.odds:
        table = new_table("group", "milestone", "late", "late of others", "odds ratio", title="odds of being late")
        for row in summary.odds:
            others = f"{row.late_others} of {row.others}"
            table.add_row(
                row.group, row.trial, f"{row.late} of {row.n}", others, _ratio((row.odds_ratio, row.low, row.high))
            )
        out.print(table)
        published = ", ".join(f"{group} {_ratio(odds)}" for group, odds in summary.published_odds.items())
        out.print(f"published: {published}: {summary.odds_source}")
        out.print("late: more than one SD above the mean; groups: the uppermost tenth; in brackets: 95 % intervals")


def _months(months: float | None) -> str:
    return "" if months is None else f"{months:.2f}"


def _ratio(odds: tuple[float, float, float]) -> str:
    return "{:.2f} ({:.2f} to {:.2f})".format(*odds)


def print_movement(report: MovementReport) -> None:
    """Print a row for each measure, its value at each age and what is asked of it, the sources, and the verdict."""
    out = open_console()
    out.print(f"movement, development {report.development}, {report.actuation} actuation")
    for trial, title in report.titles.items():
        out.print(f"{trial}: {title}", highlight=False)
        out.print(_movement_table(trial, report))
    for source, names in _sources(report).items():
        out.print(f"{', '.join(names)}: {source}", highlight=False)
    for reason in dict.fromkeys(f"{row.trial} was not tried: {row.reason}" for row in report.rows if row.reason):
        out.print(reason)
    if report.held_out:
        inside = sum(not row.failed for row in report.held_out)
        title = f"held out, facts that were read and have a direction: {inside} of {len(report.held_out)} inside"
        out.print(_held_out(report.held_out, title))
    out.print("*: outside the window of real infants; -: does not happen; in brackets: the window is an assumption")
    failing = [name for name, rows in report.by_measure.items() if any(row.failed for row in rows)]
    if failing:
        out.print(Text(f"failed: outside the window of real infants: {', '.join(failing)}", style="red"))
    else:
        out.print(Text("ok: every movement is inside the window of real infants", style="green"))


def _movement_table(trial: str, report: MovementReport) -> Table:
    """Return a table of the measures of a trial by age, a row each, or one for each side where these differ."""
    measures = [rows for rows in report.by_measure.values() if rows[0].trial == trial]
    asked = any(map(_asked, measures))
    headings = [f"{row.age_months:g}" for row in measures[0]] + ["asked", "used"] * asked
    table = new_table("months", *headings, padding=0)
    for child, one in {"": report, **report.beside}.items():
        by_values: dict[tuple[str, ...], list[Sequence[MovementRow]]] = {}
        for rows in (rows for rows in one.by_measure.values() if rows[0].trial == trial):
            values = [f"{_movement_value(row)}" for row in rows]
            by_values.setdefault((rows[0].measure.name, *values), []).append(rows)
        for (name, *_), alike in by_values.items():
            label = alike[0][0].name if len(alike) == 1 else name
            cells = [_asked(alike[0]), _used(alike[0])] * asked
            table.add_row(f"{label} ({child})" if child else label, *map(_movement_value, alike[0]), *cells)
    return table


def _held_out(rows: Sequence[MovementRow], title: str) -> Table:
    """Return a table of what is held out, a row each, and how far those outside are below or above their windows."""
    table = new_table("measure", "months", "value", "asked", "off by", title=title, padding=0)
    for row in rows:
        error = "never" if row.error is None else _signed(row.error) if row.failed else "inside"
        window = _range(row.window) if row.window else ""
        table.add_row(row.name, f"{row.age_months:g}", _movement_value(row), window, error)
    return table


def _used(rows: Sequence[MovementRow]) -> str:
    uses = list(dict.fromkeys(row.window.used for row in rows if row.window))
    return "by age" if len(uses) > 1 else "".join(uses)


def _sources(report: MovementReport) -> Mapping[str, Sequence[str]]:
    """Return the measures that each source is about, by what it says, how surely, and what it is used for."""
    names: dict[str, dict[str, None]] = {}
    for row in report.rows:
        if window := row.window:
            source = f"{window.source} ({window.certainty}; {window.used})"
            names.setdefault(source, {})[row.measure.name] = None
    return {source: list(measures) for source, measures in names.items()}


def _movement_value(row: MovementRow) -> Text:
    text = "-" if row.value is None else readable(row.value)
    if row.reason:
        return Text("not tried")
    if row.window and row.window.certainty == "assumption":
        return Text(f"({text})")
    return Text(f"{text}{'*' if row.failed else ' '}", style="yellow" if row.failed else "")


def _asked(rows: Sequence[MovementRow]) -> str:
    ranges = list(dict.fromkeys(_range(row.window) for row in rows if row.window))
    return "by age" if len(ranges) > 1 else "".join(ranges)


def _range(window: Window) -> str:
    if window.low is None:
        return f"≤ {window.high:g}"
    return f"≥ {window.low:g}" if window.high is None else f"{window.low:g} to {window.high:g}"


def _signed(value: float) -> str:
    return f"{'+' if value > 0 else ''}{readable(value)}"


SHOWN = 10
"""Failed jobs that are listed; all are in the table."""


def print_plan(plan: Plan) -> None:
    """Print what each step will take, and all together."""
    console = open_console()
    headings = ("step", "jobs", "done", JOB_TIME.heading, TIME_LEFT.heading, JOB_SIZE.heading)
    table = new_table(*headings, title=f"{counted(plan.infants, 'infant')}, {counted(plan.jobs, 'job')}")
    for step in plan.steps:
        table.add_row(*_plan_row(step, plan.processes))
    console.print(table)
    more = "at least " if any(step.at_least for step in plan.steps) else ""
    cores = counted(plan.processes, "core")
    console.print(f"{more}{_duration(plan.hours)} on {cores}, {more}{plan.bytes / 1e6:.0f} MB on disk")
    for step in plan.steps:
        if step.error:
            console.print(Text(f"the trial of '{step.step}' failed: {step.error}", style="yellow"))


def _plan_row(step: StepPlan, processes: int) -> tuple[str, ...]:
    if step.seconds is None:
        return step.step, f"{step.jobs}", f"{step.done}", "", "0", ""
    more = "> " if step.at_least else ""
    hours = (step.jobs - step.done) * step.seconds / processes / 3600
    seconds = f"{more}{readable(step.seconds)}"
    return step.step, f"{step.jobs}", f"{step.done}", seconds, f"{more}{readable(hours, 2)}", f"{step.bytes / 1000:.0f}"


def print_status(status: Status) -> None:
    """Print how many jobs of each step are done, and the first that have failed."""
    console = open_console()
    table = new_table("step", "ok", "failed", "missing", title=counted(status.jobs, "job"))
    for step, counts in status.counts.items():
        table.add_row(step, *(f"{counts.get(state, 0)}" for state in ("ok", "failed", "missing")))
    console.print(table)
    for failure in status.failures[:SHOWN]:
        seed = {} if failure.job.seed is None else {"seed": failure.job.seed}
        who = ", ".join(f"{name}={value}" for name, value in {**failure.job.factors, **seed}.items())
        console.print(Text(f"failed: {' '.join((failure.job.step, who)).rstrip()}: {failure.error}", style="red"))
        console.print(f"        {failure.log}")
    if len(status.failures) > SHOWN:
        console.print(f"... and {len(status.failures) - SHOWN} more; see the table")


def _duration(hours: float) -> str:
    if hours < 1 / 60:
        return f"{3600 * hours:.0f} s"
    return f"{60 * hours:.0f} min" if hours < 2 else f"{hours:.1f} h"


def print_quantities(quantities: Iterable[Quantity]) -> None:
    """Print what can be measured: name, unit and definition."""
    table = new_table("name", "unit", "what it is", left=3)
    for item in quantities:
        table.add_row(item.name, item.unit, f"{item.label}: {item.about}")
    open_console().print(table)


PARTS_SHOWN = 6
"""Pairs of parts that are printed for each pair of infants."""


def print_measured(columns: Mapping[str, Mapping[str, Sequence[float | None]]], title: str) -> None:
    """Print the quantities of episodes, by infant: of several, mean, standard deviation (n - 1), and how many."""
    values = {
        who: {name: [value for value in column if value is not None] for name, column in of_infant.items()}
        for who, of_infant in columns.items()
    }
    several = any(len(column) > 1 for of_infant in values.values() for column in of_infant.values())
    headings = ("mean", "SD", "n") if several else ("value",)
    if len(values) > 1:
        headings = [f"{who} {heading}" if several else who for who in values for heading in headings]
    table = new_table("measure", *headings, title=title)
    for name in next(iter(values.values())):
        cells = [cell for of_infant in values.values() for cell in _spread(of_infant[name], several)]
        table.add_row(QUANTITIES[name].title, *cells)
    open_console().print(table)


def _spread(values: Sequence[float], several: bool) -> list[str]:
    mean = readable(fmean(values)) if values else "-"
    return [mean, readable(stdev(values), 2) if len(values) > 1 else "-", f"{len(values)}"] if several else [mean]


def print_contacts(table: Mapping[str, Sequence[Any]], title: str) -> None:
    """Print who touches and looks at whom, in all episodes together, and the parts that do so for longest."""
    keys = [*zip(*(table[name] for name in ("infant", "does", "other", "part", "other_part")), strict=True)]
    seconds, times = dict[tuple[str, ...], float](), dict[tuple[str, ...], int]()
    for key, length_s, count in zip(keys, table["seconds"], table["times"], strict=True):
        seconds[key], times[key] = seconds.get(key, 0.0) + length_s, times.get(key, 0) + count
    printed = new_table("who", "with", "what", "seconds", "times", title=title, left=3)
    wholes = [key for key in seconds if key[4] == "any"]
    for whole in wholes:
        printed.add_row(" ".join(whole[:3]), "", "", readable(seconds[whole]), f"{times[whole]}")
        parts = sorted((key for key in seconds if key[:3] == whole[:3] and key != whole), key=lambda key: -seconds[key])
        for key in parts[:PARTS_SHOWN]:
            printed.add_row("", *(name.replace("_", " ") for name in key[3:]), readable(seconds[key]), f"{times[key]}")
    open_console().print(printed)
