"""Console output of an infant's growth next to WHO's standards."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from mimoc.cli.console import open_console
from mimoc.quantities.child import INDICATORS

if TYPE_CHECKING:
    from mimoc.compiler.validation import GrowthReport, Row
    from mimoc.fits.who import Reference

POPULATIONS: Mapping[Reference, str] = {"male": "boys", "female": "girls", "mean": "boys and girls"}
Column = Callable[["Row"], "str | Text"]


def print_growth(report: GrowthReport, requested_sd: float) -> None:
    """Print one table per growth indicator, with a row for each age, and the verdict.

    Args:
        report: The comparison.
        requested_sd: How far measures may be from what the spec asks for, in standard deviations.
    """
    console = open_console()
    for indicator, rows in report.by_indicator.items():
        console.print(f"{INDICATORS[indicator].title} against WHO's {POPULATIONS[report.reference]}")
        console.print(_table(rows))
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


def _table(rows: Sequence[Row]) -> Table:
    table = Table(collapse_padding=True, pad_edge=False)
    columns = _columns(rows)
    for heading in columns:
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(*(column(row) for column in columns.values()))
    return table


def _columns(rows: Sequence[Row]) -> Mapping[str, Column]:
    """Return the columns that have something to say about these rows, by heading."""
    reference = rows[0].reference
    found: dict[str, Column] = {"months": lambda row: f"{row.age_months:g}", "infant": lambda row: f"{row.value:.2f}"}
    if reference == "mean":
        found |= {"z boys": lambda row: f"{row.z['male']:+.2f}", "z girls": lambda row: f"{row.z['female']:+.2f}"}
    found |= {"z": _z, "percentile": lambda row: f"{row.percentile[reference]:.1f}"}
    if any(row.requested_z is not None for row in rows):
        found["z asked for"] = lambda row: "" if row.requested_z is None else f"{row.requested_z:+.2f}"
    if any(row.missed for row in rows):
        found["verdict"] = lambda row: "missed" if row.missed else ""
    return found


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
