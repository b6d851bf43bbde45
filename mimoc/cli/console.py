"""Console output of the commands."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, Task, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from mimoc.bundle.manifest import Manifest
    from mimoc.cli.doctor import Finding
    from mimoc.compiler.explain import Explanation
    from mimoc.runtime.check import PoseCheck
    from mimoc.runtime.rollout import Summary

LABELS = {
    "length_cm": "length [cm]",
    "weight_kg": "weight [kg]",
    "head_circumference_cm": "head circumference [cm]",
    "arm_circumference_cm": "arm circumference [cm]",
}


PIPE_WIDTH = 200
"""Width of the output when it is piped: wide enough that lines are not broken, for `grep`."""


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Exit; `mimoc.cli.entry` handles output that is no longer read."""
        raise SystemExit(1)


def open_console() -> Console:
    """Return a console on standard output that does not break lines in a pipe."""
    return _Console(markup=False, highlight=False, width=None if sys.stdout.isatty() else PIPE_WIDTH)


@contextmanager
def progress(what: str) -> Iterator[Callable[..., None]]:
    """Show a progress bar with the time left if errors go to a terminal; until it is told a total, it only moves.

    Yields:
        The function to call with the steps done and their total, and with another text before the bar if it changes.
    """
    if not sys.stderr.isatty():
        yield lambda done, total, what=what: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), _Steps(), TimeRemainingColumn())
    above = sys.stdout.isatty()  # What is printed meanwhile goes above the bar, if it goes to the terminal as well.
    with Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=above) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total, what=what: bar.update(task, completed=done, total=total, description=what)


class _Steps(MofNCompleteColumn):
    def render(self, task: Task) -> Text:
        """Return the steps done and their total, or nothing until there is one."""
        return super().render(task) if task.total is not None else Text()


def print_child(manifest: Manifest, percentiles: dict[str, float]) -> None:
    """Print a child's measures and their WHO percentiles."""
    measures = manifest.child.model_dump()
    table = Table(title=f"{manifest.name}, {manifest.child.age_months:g} months", title_justify="left")
    table.add_column("measure")
    table.add_column("value", justify="right")
    population = {"male": "boys", "female": "girls", None: "boys and girls"}[manifest.child.sex]
    table.add_column(f"WHO percentile, {population}", justify="right")
    for name, value in percentiles.items():
        table.add_row(LABELS[name], f"{measures[name]:.2f}", f"{value:.0f}")
    open_console().print(table)


def print_findings(findings: Sequence[Finding]) -> None:
    """Print what was found out about this machine, a line each."""
    styles = {"ok": "green", "none": "dim", "broken": "red"}
    width = max(len(finding.what) for finding in findings)
    for what, state, text in findings:
        open_console().print(Text.assemble((f"{state:6}", styles[state]), f" {what:{width}}  {text}"), soft_wrap=True)


def print_toys(manifest: Manifest) -> None:
    """Print the toys of the scene and the notes on the build."""
    console = open_console()
    if manifest.toys:
        table = Table(title=f"{len(manifest.toys)} toys", title_justify="left")
        table.add_column("toy")
        for heading in ("longest side [cm]", "weight [g]"):
            table.add_column(heading, justify="right")
        for toy in manifest.toys:
            table.add_row(printable(toy.object), f"{100 * toy.size_m:.1f}", f"{1000 * toy.mass_kg:.0f}")
        console.print(table)
    for note in manifest.notes:
        console.print(Text(f"note: {note}", style="yellow"))


METRICS = {
    "hand_error_m": "distance from hand to target after 1.5 s, median [m]",
    "fell_after_s": "too weak or too unsteady to sit unsupported: fell over after [s]",
}
"""Labels of some metrics of policies, by name."""


def print_run(summary: Summary) -> None:
    """Print the summary of a run and its speed."""
    table = Table(title=f"{summary.steps} control steps, {summary.simulated_s:g} s simulated", title_justify="left")
    table.add_column("quantity")
    table.add_column("value", justify="right")
    low, high = summary.head_height_m
    rows = {
        "episodes": f"{summary.episodes}",
        "total reward": f"{summary.total_reward:.6g}",
        **_outcomes(summary),
        "path length of the hip [m]": f"{summary.hip_path_m:.6f}",
        "minimum height of the head [m]": f"{low:.6f}",
        "maximum height of the head [m]": f"{high:.6f}",
        "mean joint speed [rad/s]": f"{summary.joint_speed_rad_s:.6f}",
        "stable": "no: the simulation became unstable" if summary.unstable else "yes",
    }
    for name, value in summary.metrics.items():
        rows[METRICS.get(name, name.replace("_", " "))] = f"{value:.6g}"
    for what, value in rows.items():
        table.add_row(what, value)
    console = open_console()
    console.print(table)
    rate_hz = summary.steps / summary.wall_s
    console.print(f"{rate_hz:.0f} steps/s, {summary.simulated_s / summary.wall_s:.1f} times real time")


def _outcomes(summary: Summary) -> dict[str, str]:
    """Return the outcomes of the completed episodes."""
    if summary.mean_return is None:
        return {"successes": "0 of 0 completed episodes"} if summary.task != "free" else {}
    share = summary.successes / summary.finished
    found = {
        "mean return per episode": f"{summary.mean_return:.6g}",
        "successes": f"{summary.successes} of {summary.finished} completed episodes ({share:.0%})",
    }
    if summary.time_to_success_s is not None:
        found["mean time to success [s]"] = f"{summary.time_to_success_s:.3f}"
    return found


def print_check(check: PoseCheck) -> None:
    """Print the result for a pose."""
    verdict = Text("ok    ", style="green") if check.passed else Text("failed", style="red")
    warnings = ", ".join(check.warnings) or "no warnings"
    open_console().print(verdict, f"{check.pose}: {warnings}, {_extremes(check)}")


def _extremes(check: PoseCheck) -> str:
    """Return the largest kinetic energy and the largest violation of a joint limit as text."""
    energy = f"kinetic energy at most {check.energy_j_per_kg:.2f} J/kg"
    if not check.joint:
        return f"{energy}, no joint limit exceeded"
    return f"{energy}, joint limits exceeded by at most {check.beyond_deg:.0f} degrees ({check.joint})"


def print_explanation(explanation: Explanation, legend: str) -> None:
    """Print the provenance of a number as a tree, and below it what its marks mean."""
    open_console().print(_branch(explanation))
    if legend:
        open_console().print(Text(legend))


def print_contents(contents: Mapping[str, Sequence[str]]) -> None:
    """Print the names of numbers, one line per object, so that they can be searched with `grep`."""
    for thing, names in contents.items():
        print(f"{thing}: {' '.join(names)}")
    if sys.stdout.isatty():
        print("\nGive a name such as body.head.mass to see where the number comes from, or part of a name to search")


def print_numbers(numbers: Mapping[str, str]) -> None:
    """Print numbers, one per line."""
    for key, value in numbers.items():
        print(f"{key} = {value}")
    if sys.stdout.isatty():
        print("\nGive the full name of a number to see where it comes from")


def _branch(explanation: Explanation) -> Tree:
    value, *reasons = explanation.lines
    tree = Tree(Text.assemble((explanation.key, "bold"), " = ", (value, "green")))
    for reason in reasons:
        tree.add(Text(reason))
    for source in explanation.sources:
        tree.children.append(_branch(source))
    return tree
