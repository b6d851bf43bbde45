"""`mimoc cohort`: plan, run, status, table, milestones and retry."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import mimoc
from mimoc.base.errors import counted
from mimoc.base.rounding import readable
from mimoc.cli.arguments import AsJson
from mimoc.cli.terminal import FAILED_CHECK, printable, resumable

if TYPE_CHECKING:
    from mimoc.studies.cohorts.cohort import Plan, Status, StepPlan
    from mimoc.studies.cohorts.table import MilestoneSummary

MAX_FAILURES = 10  # Number of failed jobs that are listed; all are in the table.

app = typer.Typer(
    name="cohort",
    help="Build, check, run or train many infants, and gather one table.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)

CohortPath = Annotated[Path, typer.Argument(metavar="COHORT", help="YAML file that describes the cohort.")]
Out = Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder of the cohort.")]
On = Annotated[str, typer.Option(help="Where the jobs are done: local (processes on this machine), slurm or ray.")]
Processes = Annotated[int | None, typer.Option(min=1, help="local: processes; default: as many as cores may be used.")]
Partition = Annotated[str | None, typer.Option(help="slurm: partition; default: SLURM's own.")]
Time = Annotated[int | None, typer.Option(min=1, metavar="MINUTES", help="slurm: time for a task [default: 60].")]
Memory = Annotated[float | None, typer.Option(metavar="GB", help="slurm: memory of a task.")]
ArrayLimit = Annotated[int | None, typer.Option(min=1, help="slurm: tasks of an array that run at once.")]
Address = Annotated[str | None, typer.Option(help="ray: address of the cluster; default: a fresh one on this machine.")]
JobsPerTask = Annotated[
    int | None, typer.Option(min=1, help="slurm, ray: jobs of a task [default: 50; of train, experiment: 1].")
]
CsvOnly = Annotated[bool, typer.Option("--csv", help="Write only the CSV, which needs no `mimoc[record]`.")]


@app.command(epilog="Example:  mimoc cohort plan spring.yaml -o out/spring")
def plan(cohort: CohortPath, out: Out) -> None:
    """Say how many jobs there are, and how much time and space they take, after a short trial of each step."""
    from mimoc.cli import console
    from mimoc.studies.cohorts.cohort import plan as planned

    with console.progress("trying each step") as show:
        estimate = planned(mimoc.read_cohort(cohort), out, show)
    _print_plan(estimate)


@app.command(epilog="Example:  mimoc cohort run spring.yaml -o out/spring")
def run(
    cohort: CohortPath,
    out: Out,
    on: On = "local",
    index: Annotated[int, typer.Option(min=0, metavar="I", help="Do only share I of the jobs, from 0 on.")] = 0,
    of: Annotated[int, typer.Option(min=1, metavar="N", help="Number of shares.")] = 1,
    processes: Processes = None,
    partition: Partition = None,
    time: Time = None,
    memory: Memory = None,
    array_limit: ArrayLimit = None,
    address: Address = None,
    jobs_per_task: JobsPerTask = None,
) -> None:
    """Do all jobs that have no result yet; run the same command again after an interruption."""
    options = {
        "partition": partition,
        "time_min": time,
        "memory_gb": memory,
        "array_limit": array_limit,
        "processes": processes,
        "address": address,
        "jobs_per_task": jobs_per_task,
    }
    _carry_out(partial(mimoc.Cohort.run, index=index, of=of), cohort, out, on, options)


@app.command(epilog="Example:  mimoc cohort retry spring.yaml -o out/spring")
def retry(
    cohort: CohortPath,
    out: Out,
    on: On = "local",
    processes: Processes = None,
    partition: Partition = None,
    time: Time = None,
    memory: Memory = None,
    array_limit: ArrayLimit = None,
    address: Address = None,
    jobs_per_task: JobsPerTask = None,
) -> None:
    """Do the failed jobs again, and those that have no result yet."""
    options = {
        "partition": partition,
        "time_min": time,
        "memory_gb": memory,
        "array_limit": array_limit,
        "processes": processes,
        "address": address,
        "jobs_per_task": jobs_per_task,
    }
    _carry_out(mimoc.Cohort.retry, cohort, out, on, options)


@app.command(epilog="Example:  mimoc cohort status spring.yaml -o out/spring")
def status(cohort: CohortPath, out: Out) -> None:
    """Say how many jobs are done, and which have failed and why."""
    _print_status(mimoc.read_cohort(cohort).status(out))


@app.command(epilog="Example:  mimoc cohort table spring.yaml -o out/spring")
def table(cohort: CohortPath, out: Out, csv: CsvOnly = False) -> None:
    """Write one row a job into `table.csv` and `table.parquet`: all factors, all measures, versions and seeds."""
    from mimoc.cli import console

    study = mimoc.read_cohort(cohort)
    # The CSV is written first by itself, so that it exists, and is said to, if pyarrow is missing.
    rounds = (False,) if csv else (False, True)
    for parquet in rounds:
        with console.progress("reading results") as show:
            written = study.table(out, parquet=parquet, progress=show)
        print(printable(written[-1]))


@app.command(epilog="Example:  mimoc cohort milestones spring.yaml -o out/spring")
def milestones(
    cohort: CohortPath,
    out: Out,
    as_json: AsJson = False,
) -> None:
    """Say when the children reach milestones, beside WHO's children, and whether the heavy and the fat are late."""
    from mimoc.cli import console
    from mimoc.studies.cohorts.table import milestone_summary

    study = mimoc.read_cohort(cohort)
    with console.progress("reading results") as show:
        summary = milestone_summary(study.rows(out, progress=show))
    if as_json:
        print(json.dumps(summary.to_data(), indent=1))
    else:
        _print_milestones(summary)


def _carry_out(action: "Callable[..., Status]", cohort: Path, out: Path, on: str, options: dict[str, Any]) -> None:
    """Run or retry jobs, print their status and the next command; the exit code is 1 if any job has failed."""
    from mimoc.cli import console

    given = {name: value for name, value in options.items() if value is not None}
    with console.progress("running") as show, resumable():
        status = action(mimoc.read_cohort(cohort), out, on, progress=show, **given)
    _print_status(status)
    if status.failures:
        print(printable(f"{out}: try again with: mimoc cohort retry {cohort} -o {out}"))
        raise typer.Exit(FAILED_CHECK)
    print(printable(f"{out}: gather the table with: mimoc cohort table {cohort} -o {out}"))


def _print_plan(plan: "Plan") -> None:
    from mimoc.base.quantities import JOB_SIZE, JOB_TIME, TIME_LEFT
    from mimoc.cli.console import print_line, print_table

    headings = ("step", "jobs", "done", JOB_TIME.heading, TIME_LEFT.heading, JOB_SIZE.heading)
    rows = (_plan_row(step, plan.processes) for step in plan.steps)
    print_table(headings, rows, title=f"{counted(plan.infants, 'infant')}, {counted(plan.jobs, 'job')}")
    bound = "at least " if any(step.at_least for step in plan.steps) else ""
    duration = f"{60 * plan.hours:.0f} min" if plan.hours < 2 else f"{plan.hours:.1f} h"
    if plan.hours < 1 / 60:
        duration = f"{3600 * plan.hours:.0f} s"
    print_line(f"{bound}{duration} on {counted(plan.processes, 'core')}, {bound}{plan.bytes / 1e6:.0f} MB on disk")
    for step in plan.steps:
        if step.error:
            print_line(f"the trial of '{step.step}' failed: {step.error}", "yellow")


def _plan_row(step: "StepPlan", processes: int) -> tuple[str, ...]:
    if step.seconds is None:
        return step.step, f"{step.jobs}", f"{step.done}", "", "0", ""
    bound = "> " if step.at_least else ""
    hours = (step.jobs - step.done) * step.seconds / processes / 3600
    seconds = f"{bound}{readable(step.seconds)}"
    return (
        step.step,
        f"{step.jobs}",
        f"{step.done}",
        seconds,
        f"{bound}{readable(hours, 2)}",
        f"{step.bytes / 1000:.0f}",
    )


def _print_status(status: "Status") -> None:
    from mimoc.cli.console import print_line, print_table

    states = "ok", "failed", "missing"
    rows = ((step, *(f"{counts.get(state, 0)}" for state in states)) for step, counts in status.counts.items())
    print_table(("step", *states), rows, title=counted(status.jobs, "job"))
    for failure in status.failures[:MAX_FAILURES]:
        seed = {} if failure.job.seed is None else {"seed": failure.job.seed}
        factors = ", ".join(f"{name}={value}" for name, value in {**failure.job.factors, **seed}.items())
        print_line(f"failed: {' '.join((failure.job.step, factors)).rstrip()}: {failure.error}", "red")
        print_line(f"        {failure.log}")
    if len(status.failures) > MAX_FAILURES:
        print_line(f"... and {len(status.failures) - MAX_FAILURES} more; see the table")


def _print_milestones(summary: "MilestoneSummary") -> None:
    """Print the ages at which the children of a cohort reach milestones, and the odds of being late, with sources."""
    from mimoc.base.quantities import MEAN_AGE
    from mimoc.cli.console import print_line, print_table

    headings = ("milestone", "n", "not by 24", MEAN_AGE.heading, "SD", "WHO's mean", "WHO's SD", "WHO's milestone")
    rows = []
    for row in summary.spreads:
        months = row.mean_months, row.sd_months, row.who_mean_months, row.who_sd_months
        cells = ("" if value is None else f"{value:.2f}" for value in months)
        rows.append((row.trial, f"{row.n}", f"{row.not_reached}", *cells, row.who))
    print_table(headings, rows, title="ages of milestones")
    print_line(f"WHO: {summary.who_source}")
    if summary.odds:
        ratio = "{:.2f} ({:.2f} to {:.2f})".format
        rows = []
        for row in summary.odds:
            others = f"{row.late_others} of {row.others}"
            odds = ratio(row.odds_ratio, row.low, row.high)
            rows.append((row.group, row.trial, f"{row.late} of {row.n}", others, odds))
        headings = ("group", "milestone", "late", "late of others", "odds ratio")
        print_table(headings, rows, title="odds of being late")
        published = ", ".join(f"{group} {ratio(*odds)}" for group, odds in summary.published_odds.items())
        print_line(f"published: {published}: {summary.odds_source}")
        print_line("late: more than one SD above the mean; groups: the uppermost tenth; in brackets: 95 % intervals")
