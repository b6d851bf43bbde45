"""Console output of an infant's measurements next to those of AnthroKids."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from mimoc.cli.console import open_console

if TYPE_CHECKING:
    from mimoc.compiler.validation import MeasurementReport, MeasurementRow


def print_measurements(report: MeasurementReport, tolerance: float) -> None:
    """Print one row for each measurement, with its deviation from the mean of each age group, and the verdict.

    Args:
        report: The comparison.
        tolerance: Largest deviation, relative to the mean.
    """
    console = open_console()
    ages_months = report.ages_months
    table = Table(title="deviation from AnthroKids' means [%]", title_justify="left", pad_edge=False)
    table.add_column("months")
    for age_months in ages_months:
        table.add_column(f"{age_months:g}", justify="right")
    table.add_column("largest", justify="right")
    failing = []
    for name, rows in report.by_measurement():
        worst = max(rows.values(), key=lambda row: abs(row.deviation))
        cells = [_deviation(rows[age]) if age in rows else Text("") for age in ages_months]
        table.add_row(name.replace("_", " "), *cells, f"{worst.value_cm:.2f} cm, not {worst.mean_cm:.2f}")
        failing += [name] if worst.outside else []
    console.print(table)
    verdict = f"within {100 * tolerance:g} % of AnthroKids' mean in every age group"
    if failing:
        console.print(Text(f"failed: not {verdict}: {', '.join(failing)}", style="red"))
    else:
        console.print(Text(f"ok: {verdict}", style="green"))


def _deviation(row: MeasurementRow) -> Text:
    """Return a deviation as text, in yellow and with a star if it is too large."""
    return Text(f"{100 * row.deviation:+.1f}{'*' if row.outside else ' '}", style="yellow" if row.outside else "")
