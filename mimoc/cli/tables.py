"""Console output of comparisons: growth, measurements, motor milestones and movement, beside real children."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from rich.text import Text

from mimoc.base.errors import counted
from mimoc.base.movement_quantities import CORE
from mimoc.base.quantities import DIFFERENCE, FROM_AGE, INDICATORS, QUANTITIES
from mimoc.base.rounding import readable
from mimoc.cli.console import print_line, print_table, print_verdict, starred
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from mimoc.fits.standards import Reference
    from mimoc.movement.report import MovementMeasures, Spread
    from mimoc.studies.comparison import Reference as RealInfants
    from mimoc.studies.growth import GrowthReport, GrowthRow, MeasurementReport, MeasurementRow
    from mimoc.studies.milestones import Milestone, MilestoneReport
    from mimoc.studies.milestones.trial import Conditions
    from mimoc.studies.movement import MovementReport, Row as MovementRow

POPULATIONS: Mapping[Reference, str] = {"male": "boys", "female": "girls", "mean": "boys and girls"}
Column = Callable[["GrowthRow"], "str | Text"]


def print_growth(report: GrowthReport, requested_sd: float) -> None:
    """Print one table per growth indicator, with a row for each age, and the verdict."""
    for indicator, rows in report.by_indicator.items():
        print_line(f"{INDICATORS[indicator].title} against WHO's {POPULATIONS[report.reference]}")
        columns = _growth_columns(rows)
        cells = [[column(row) for column in columns.values()] for row in rows]
        print_table(columns, cells, left=0, collapse_padding=True, pad_edge=False)
        worst = max(rows, key=lambda row: abs(row.deviation))
        what = "what is asked for" if worst.requested_z is not None else "the median"
        deviation = round(worst.deviation, 2) + 0.0  # Which turns -0.0 into 0.
        print_line(f"largest deviation from {what}: {deviation:+.2f} SD at {worst.age_months:g} months\n")
    goals = {
        "within one SD of the mean of WHO's boys and girls": [row for row in report.rows if row.requested_z is None],
        f"as asked for, within {requested_sd:g} SD": [row for row in report.rows if row.requested_z is not None],
    }
    for goal, rows in goals.items():
        judged = [row for row in rows if row.is_judged]
        if failing := sorted({row.indicator for row in judged if row.missed}):
            print_verdict(False, f"not {goal} at every age: {', '.join(failing)}")
        elif judged:
            print_verdict(True, f"{goal} at every age: {_names(judged)}")
    if reported := [row for row in report.rows if not row.is_judged]:
        print_line(f"follows from other keys of the spec, and is not judged: {_names(reported)}")


def _growth_columns(rows: Sequence[GrowthRow]) -> Mapping[str, Column]:
    reference = rows[0].reference
    columns: dict[str, Column] = {"months": lambda row: f"{row.age_months:g}", "infant": lambda row: f"{row.value:.2f}"}
    if reference == "mean":
        columns |= {"z boys": lambda row: f"{row.z['male']:+.2f}", "z girls": lambda row: f"{row.z['female']:+.2f}"}
    columns |= {
        "z": lambda row: starred(f"{row.z[reference]:+.2f}", row.missed),
        "percentile": lambda row: f"{row.percentile[reference]:.1f}",
    }
    if any(row.requested_z is not None for row in rows):
        columns["z asked for"] = lambda row: "" if row.requested_z is None else f"{row.requested_z:+.2f}"
    if any(row.missed for row in rows):
        columns["verdict"] = lambda row: "missed" if row.missed else ""
    return columns


def _names(rows: Sequence[GrowthRow]) -> str:
    return ", ".join(dict.fromkeys(INDICATORS[row.indicator].label.lower() for row in rows))


def print_measurements(report: MeasurementReport, tolerance: float) -> None:
    """Print one row for each measurement, with its deviation in each age group, the largest of all, and the verdict."""
    is_average = all(row.requested == 1 for row in report.rows)
    goal = "AnthroKids' means" if is_average else "AnthroKids' means, as scaled by the spec"
    print_line(f"{DIFFERENCE.heading} from {goal}")
    rows = (
        (name.replace("_", " "), *(_deviation(rows[age]) if age in rows else "" for age in report.ages_months))
        for name, rows in report.by_measurement()
    )
    print_table(("months", *(f"{age_months:g}" for age_months in report.ages_months)), rows, padding=0)
    worst = max((row for row in report.rows if row.is_judged), key=lambda row: abs(row.deviation))
    print_line(
        f"largest: {worst.measurement.replace('_', ' ')} at {worst.age_months:g} months, {worst.value_cm:.2f} cm "
        f"({100 * worst.deviation:+.1f} %)"
    )
    verdict = f"within {100 * tolerance:g} % of {goal}{'' if is_average else ','} in every age group"
    failing = [name for name, rows in report.by_measurement() if any(row.outside for row in rows.values())]
    print_verdict(not failing, f"not {verdict}: {', '.join(failing)}" if failing else verdict)
    if reported := dict.fromkeys(row.measurement.replace("_", " ") for row in report.rows if not row.is_judged):
        print_line(f"in brackets: changed by other keys of the spec, and not judged: {', '.join(reported)}")


def _deviation(row: MeasurementRow) -> Text | str:
    """Return a deviation, with a star if it is too large, in brackets if it is not judged."""
    text = f"{100 * row.deviation:+.1f}"
    return starred(text, row.outside) if row.is_judged else f"({text})"


def print_milestones(report: MilestoneReport) -> None:
    """Print a row for each milestone, the sources, and the verdict."""
    tried = _conditions_in_words(report.conditions)
    print_line(f"motor milestones, development {report.development}, {report.actuation} actuation; {tried}")
    healthy = [other.milestones for other in report.beside.values()]
    rows = [
        row
        for milestone, *others in zip(report.milestones, *healthy, strict=True)
        for row in _milestone_rows(milestone, others)
    ]
    headings = ("milestone", FROM_AGE.heading, *report.beside, "real infants", "usual", "verdict", "age")
    print_table(headings, rows, padding=0)
    for milestone in report.milestones:
        window = milestone.window
        source = f"; {window.span}: {window.source} ({window.certainty})" if window else ""
        print_line(f"{milestone.trial.name}: {milestone.trial.title}{source}")
    print_line("from: the youngest age at which, and at all older ages tried, the infant succeeds")
    if any(item.of_average and item.window and item.window.sd_months for item in report.milestones):
        print_line("real infants: of WHO's milestones, mean ± 1 SD, since this is the average child")
    if early := report.milestones[0].months_early if report.milestones else 0.0:
        print_line(
            f"born {early:.1f} months early: ages are since birth, and judged by the corrected age, {early:.1f} less"
        )
    print_line("age: fitted if a number of the law was chosen to reproduce it, which the verdict says; else predicted")
    failing = [f"{item.trial.name} {item.side}".rstrip() for item in report.milestones if item.failed]
    _print_windows("milestone", failing)


def _conditions_in_words(conditions: Conditions) -> str:
    if not conditions.are_of_nerves:
        return "the body alone, without delays and noise"
    if not conditions.noise:
        return "with delays of senses and commands, without noise"
    half = f"an attempt counts if at least half of {conditions.seeds} seeds succeed"
    return f"with {'delays and ' if conditions.delays else ''}noise of senses and commands; {half}"


def _print_windows(what: str, failing: Sequence[str]) -> None:
    if failing:
        print_verdict(False, f"outside the window of real infants: {', '.join(failing)}")
    else:
        print_verdict(True, f"every {what} is inside the window of real infants")


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


def print_movement(report: MovementReport) -> None:
    """Print a row for each measure, its value at each age and what is asked of it, the sources, and the verdict."""
    print_line(f"movement, development {report.development}, {report.actuation} actuation")
    for trial, title in report.titles.items():
        print_line(f"{trial}: {title}")
        _print_trial(trial, report)
    sources: dict[str, dict[str, None]] = {}  # What each says, how surely, and its use; and the measures it is about.
    for row in report.rows:
        if window := row.window:
            source = f"{window.source} ({window.certainty}; {window.used})"
            sources.setdefault(source, {})[row.measure.name] = None
    for source, names in sources.items():
        print_line(f"{', '.join(names)}: {source}")
    for reason in dict.fromkeys(f"{row.trial} was not tried: {row.reason}" for row in report.rows if row.reason):
        print_line(reason)
    if report.held_out:
        inside = sum(not row.failed for row in report.held_out)
        title = f"held out, facts that were read and have a direction: {inside} of {len(report.held_out)} inside"
        print_table(
            ("measure", "months", "value", "asked", "off by"), map(_held_out, report.held_out), title, padding=0
        )
    print_line("*: outside the window of real infants; -: does not happen; in brackets: the window is an assumption")
    _print_windows("movement", [name for name, rows in report.by_measure.items() if any(row.failed for row in rows)])


def _print_trial(trial: str, report: MovementReport) -> None:
    """Print a table of the measures of a trial by age, a row each, or one for each side where these differ."""
    measures = [rows for rows in report.by_measure.values() if rows[0].trial == trial]
    asked = any(map(_asked, measures))
    printed = []
    for child, one in {"": report, **report.beside}.items():
        by_values: dict[tuple[str, ...], list[Sequence[MovementRow]]] = {}
        for rows in (rows for rows in one.by_measure.values() if rows[0].trial == trial):
            values = (f"{_movement_value(row)}" for row in rows)
            by_values.setdefault((rows[0].measure.name, *values), []).append(rows)
        for (name, *_), alike in by_values.items():
            label = alike[0][0].name if len(alike) == 1 else name
            uses = dict.fromkeys(row.window.used for row in alike[0] if row.window)
            cells = [_asked(alike[0]), "by age" if len(uses) > 1 else "".join(uses)] * asked
            printed.append((f"{label} ({child})" if child else label, *map(_movement_value, alike[0]), *cells))
    headings = "months", *(f"{row.age_months:g}" for row in measures[0]), *["asked", "used"] * asked
    print_table(headings, printed, padding=0)


def _held_out(row: MovementRow) -> tuple[str | Text, ...]:
    """Return a row of what is held out, and how far it is below or above its window if it is outside."""
    error = "never" if row.error is None else "inside"
    if row.error is not None and row.failed:
        error = f"{'+' if row.error > 0 else ''}{readable(row.error)}"
    window = _range(row.window) if row.window else ""
    return row.name, f"{row.age_months:g}", _movement_value(row), window, error


def _movement_value(row: MovementRow) -> Text | str:
    text = "-" if row.value is None else readable(row.value)
    if row.reason:
        return "not tried"
    if row.window and row.window.certainty == "assumption":
        return f"({text})"
    return starred(text, row.failed)


def _asked(rows: Sequence[MovementRow]) -> str:
    ranges = list(dict.fromkeys(_range(row.window) for row in rows if row.window))
    return "by age" if len(ranges) > 1 else "".join(ranges)


def _range(window: RealInfants) -> str:
    if window.low is None:
        return f"≤ {window.high:g}"
    return f"≥ {window.low:g}" if window.high is None else f"{window.low:g} to {window.high:g}"


FAR_SD = 2.0  # Scores beyond it are marked.
SD_DIGITS = 2


def print_movement_measures(measured: MovementMeasures, full: bool) -> None:
    """Print the measures of infants, of each side if sides differ, beside counterparts and the sample, if any."""
    core = {quantity.name for quantity in CORE}
    scores, sample = measured.scores, measured.sample
    count = len(measured.infants)
    who, what = (counted(count, "infant"), "mean") if count > 1 else (printable(measured.names[0]), "value")
    columns = {what: _cells(measured.means, measured.spreads), **_columns(measured)}
    rows = []
    for name in measured.means:
        if name in core or full:
            row: list[str | Text] = [QUANTITIES[name].title, *(cells.get(name, "") for cells in columns.values())]
            if sample and name in sample.means:
                score = starred(f"{scores[name]:+.1f}", abs(scores[name]) > FAR_SD)
                row += [_cell(sample.means[name], sample.deviations[name], sample.infants), score]
            rows.append(row)
    title = f"{who}: {what} ± SD between {measured.spread_is_over} (n)"
    print_table(("measure", *columns, *(["sample", "z"] if sample else [])), rows, title)
    if sample:
        _print_comparison(measured)
    for note in measured.notes:
        print_line(f"note: {printable(note)}", "yellow")


def _columns(measured: MovementMeasures) -> dict[str, dict[str, str]]:
    """Return what stands beside the means, by heading: each side if it differs, and the same of counterparts."""
    shows_sides = any(one.sides_differ for one in (measured, *measured.beside.values()))
    columns = {}
    for name, one in {"": measured, **measured.beside}.items():
        if name:
            columns[name] = _cells(one.means, one.spreads)
        for side, means in one.side_means.items() if shows_sides else ():
            columns[f"{name} {side}".strip()] = _cells(means, one.side_spreads[side])
    return columns


def _cells(means: Mapping[str, float], spreads: Mapping[str, Spread]) -> dict[str, str]:
    return {name: _cell(value, spreads[name].sd, spreads[name].n) for name, value in means.items()}


def _cell(mean: float, sd: float | None, n: int) -> str:
    return f"{readable(mean)} ± {'-' if sd is None else readable(sd, SD_DIGITS)} ({n})"


def _print_comparison(measured: MovementMeasures) -> None:
    from mimoc.movement.sample import DISTANCES, DRAWS, NAME

    sample = measured.sample
    if sample is None or measured.distance is None:
        return
    several = len(measured.distances) > 1
    each = sorted(measured.distances if several else measured.window_distances)
    what = "each" if several else measured.spread_is_over
    of_all = f", of {what} {each[0]:.2f} to {each[-1]:.2f} (n {len(each)})" if each else ""
    real = f" (a real infant to the other 11: {DISTANCES[0]} to {DISTANCES[2]})" if sample.name == NAME else ""
    mean = " of the mean" if several else ""
    print_line(f"distance{mean} to {printable(sample.name)}: {measured.distance:.2f}{of_all}{real}")
    if apart := measured.apart:
        about, spread = ("", "standard error") if apart.exact else ("about ", f"SD over {DRAWS} draws of real infants")
        figure = f"{about}{apart.accuracy:.2f} ± {apart.deviation:.2f} ({spread}; {counted(apart.windows, 'window')})"
        print_line(f"told apart in windows of 8 s: {figure}; .5 is chance, 1 is always")
