"""Console output of an infant's measurements next to those of AnthroKids."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from mimoc.cli.console import open_console
from mimoc.quantities.columns import DIFFERENCE

if TYPE_CHECKING:
    from mimoc.compiler.validation import MeasurementReport, MeasurementRow


def print_measurements(report: MeasurementReport, tolerance: float) -> None:
    """Print one row for each measurement, with its deviation in each age group, the largest of all, and the verdict.

    Args:
        report: The comparison.
        tolerance: Largest deviation, relative to the goal.
    """
    console = open_console()
    is_average = all(row.requested == 1 for row in report.rows)
    goal = "AnthroKids' means" + ("" if is_average else ", as scaled by the spec,")
    console.print(f"{DIFFERENCE.heading} from {goal.removesuffix(',')}")
    table = Table(padding=0)
    for heading in ("months", *(f"{age_months:g}" for age_months in report.ages_months)):
        table.add_column(heading, justify="left" if heading == "months" else "right", no_wrap=True)
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
