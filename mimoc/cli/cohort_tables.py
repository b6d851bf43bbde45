"""Output of `mimoc cohort`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from mimoc.cli.console import new_table, open_console
from mimoc.errors import counted
from mimoc.quantities.columns import JOB_SIZE, JOB_TIME, TIME_LEFT

if TYPE_CHECKING:
    from mimoc.cohorts import Status
    from mimoc.cohorts.plan import Plan, StepPlan

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
    seconds = f"{more}{step.seconds:.3g}"
    return step.step, f"{step.jobs}", f"{step.done}", seconds, f"{more}{hours:.2g}", f"{step.bytes / 1000:.0f}"


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
    """Return a duration in a unit that suits it."""
    if hours < 1 / 60:
        return f"{3600 * hours:.0f} s"
    return f"{60 * hours:.0f} min" if hours < 2 else f"{hours:.1f} h"
