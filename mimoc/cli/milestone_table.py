"""Console output of motor milestones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from mimoc.cli.console import open_console
from mimoc.quantities.columns import FROM_AGE

if TYPE_CHECKING:
    from mimoc.milestones import Milestone, MilestoneReport


def print_milestones(report: MilestoneReport) -> None:
    """Print a row for each milestone, the sources, and the verdict."""
    out = open_console()
    out.print(f"motor milestones, development {report.development}, {report.actuation} actuation")
    table = Table()
    for heading in ("milestone", FROM_AGE.heading, "real infants", "median", "verdict"):
        table.add_column(heading, justify="left" if heading in ("milestone", "verdict") else "right")
    for each in report.milestones:
        table.add_row(*_row(each))
    out.print(table)
    for milestone in report.milestones:
        window, trial = milestone.window, milestone.trial
        out.print(f"{trial.name}: {trial.title}" + (f"; {window.source} ({window.certainty})" if window else ""))
    out.print("'from': the youngest age at which, and at all older ages tried, the infant succeeds")
    failing = [each.trial.name for each in report.milestones if each.verdict not in ("inside", "no verdict")]
    if failing:
        out.print(Text(f"failed: outside the window of real infants: {', '.join(failing)}", style="red"))
    else:
        out.print(Text("ok: every milestone is inside the window of real infants", style="green"))


def _row(each: Milestone) -> tuple[str | Text, ...]:
    age, window = each.found.youngest_months, each.window
    colour = {"inside": "green", "no verdict": ""}.get(each.verdict, "red")
    return (
        each.trial.name,
        "not by 24" if age is None else "birth" if age == 0 else f"{age:g}",
        f"{window.youngest_months:g}-{window.oldest_months:g}" if window else "",
        f"{window.median_months:g}" if window else "",
        Text(each.verdict, style=colour),
    )
