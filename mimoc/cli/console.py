"""Console output of the commands."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, Task, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from mimoc.base.errors import counted
from mimoc.base.quantities import INDICATORS, TOY_MASS, TOY_SIZE, quantity_of
from mimoc.base.rounding import readable
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from mimoc.bundle.manifest import Manifest
    from mimoc.bundle.world import WorldManifest
    from mimoc.compiler.explain import Explanation
    from mimoc.policies.rollout import RunSummary
    from mimoc.runtime.check import PoseCheck

PLAIN_S, PLAIN_SHARE = 30.0, 1 / 10
"""Least time between two lines of progress, in seconds and as a share of the time so far."""
PIPE_WIDTH = 260  # Width of the output when it is piped: wide enough that lines are not broken, for `grep`.


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Exit; `mimoc.cli` handles output that is no longer read."""
        raise SystemExit(1)


def open_console() -> Console:
    """Return a console on standard output that does not break lines in a pipe."""
    return _Console(markup=False, highlight=False, width=None if sys.stdout.isatty() else PIPE_WIDTH)


@contextmanager
def progress(what: str) -> Iterator[Callable[..., None]]:
    """Show a progress bar with the time left if errors go to a terminal; until it is told a total, it only moves.

    Elsewhere there is a line now and then, if it takes long.

    Yields:
        The function to call with the steps done and their total, and with another text before the bar if it changes.
    """
    if not sys.stderr.isatty():
        yield PlainProgress(what)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), _Steps(), TimeRemainingColumn())
    above = sys.stdout.isatty()  # What is printed meanwhile goes above the bar, if it goes to the terminal as well.
    with Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=above) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total, what=what: bar.update(task, completed=done, total=total, description=what)


class PlainProgress:
    """Writes a line with the steps done and the time left, now and then."""

    def __init__(
        self, what: str, write: Callable[[str], None] | None = None, clock: Callable[[], float] = perf_counter
    ):
        self._what = what
        self._write = write or _to_errors
        self._clock = clock
        self._begun: tuple[int, float] | None = None
        self._due_s = 0.0

    def __call__(self, done: int, total: int, what: str = "") -> None:
        """Write a line if it is due."""
        now_s = self._clock()
        begun, begun_s = self._begun = self._begun or (done, now_s)
        self._due_s = self._due_s or now_s + PLAIN_S
        if now_s >= self._due_s and begun < done < total:
            left_s = (now_s - begun_s) / (done - begun) * (total - done)
            self._write(f"{what or self._what}: {done:,} of {total:,}, {duration(left_s)} left")
            self._due_s = now_s + max(PLAIN_S, PLAIN_SHARE * (now_s - begun_s))


def duration(seconds: float) -> str:
    """Return a time in a unit that suits it."""
    minutes = round(seconds / 60)
    return f"{round(seconds)} s" if seconds < 100 else f"{minutes} min" if minutes < 100 else f"{minutes / 60:.1f} h"


def _to_errors(line: str) -> None:
    print(printable(line), file=sys.stderr, flush=True)


class _Steps(MofNCompleteColumn):
    def render(self, task: Task) -> Text:
        return super().render(task) if task.total is not None else Text()


def print_table(
    headings: Iterable[str],
    rows: Iterable[Iterable[str | Text]],
    title: str | None = None,
    left: int = 1,
    **options: Any,
) -> None:
    """Print rows of cells below their headings; the first columns are aligned left, all others right."""
    table = Table(title=title, title_justify="left", **options)
    for number, heading in enumerate(headings):
        table.add_column(heading, justify="left" if number < left else "right")
    for row in rows:
        table.add_row(*row)
    open_console().print(table)


def print_line(text: object, style: str = "") -> None:
    """Print a text, in a colour if one is given."""
    open_console().print(Text(str(text), style=style))


def print_verdict(passed: bool, text: str) -> None:
    """Print whether something holds: `ok` in green or `failed` in red, and what it is about."""
    print_line(f"{'ok' if passed else 'failed'}: {text}", "green" if passed else "red")


def starred(text: str, is_marked: bool) -> Text:
    """Return a number as the text of a cell, in yellow and with a star if it is marked."""
    return Text(f"{text}{'*' if is_marked else ' '}", style="yellow" if is_marked else "")


def print_child(manifest: Manifest, percentiles: dict[str, float]) -> None:
    """Print a child's measures and their WHO percentiles, of which a child whose size is not known has none."""
    measures = manifest.child.model_dump()
    population = {"male": "boys", "female": "girls", None: "boys and girls"}[manifest.child.sex]
    if manifest.child.size_is_known:
        shown = {name: f"{value:.0f}" for name, value in percentiles.items()}
    else:
        shown = {name: "scale not known" for name in INDICATORS if measures[name] is not None}
    print_table(
        ("measure", "value", f"WHO percentile, {population}"),
        ((INDICATORS[name].title, f"{measures[name]:.2f}", text) for name, text in shown.items()),
        title=f"{manifest.name}, {manifest.child.age_months:g} months",
    )


def print_toys(manifest: Manifest | WorldManifest) -> None:
    """Print the toys and the objects of the scene, and the notes on the build."""
    if toys := manifest.toys:
        rows = ((printable(toy.object), f"{100 * toy.size_m:.1f}", f"{1000 * toy.mass_kg:.0f}") for toy in toys)
        print_table(("toy", TOY_SIZE.heading, TOY_MASS.heading), rows, title=counted(len(toys), "toy"))
    if items := manifest.objects:
        rows = ((printable(item.name), f"{1000 * item.mass_kg:.0f}", printable(item.where)) for item in items)
        headings = "object", TOY_MASS.heading, "place at the start"
        print_table(headings, rows, title=counted(len(items), "object"))
    for note in manifest.notes:
        print_line(f"note: {note}", "yellow")


DIGITS = 6  # Significant digits of what a run gives.


def print_run(summaries: Mapping[str, RunSummary]) -> None:
    """Print the summaries of a run by infant, whose name is empty if it is the only one, and the speed of the first."""
    summary = next(iter(summaries.values()))
    columns = {name: {**one.measures, **one.metrics} for name, one in summaries.items()}
    print_measures(columns, f"{summary.steps} control steps, {summary.simulated_s:g} s simulated")
    print_line(f"{counted(summary.episodes, 'episode')}, total reward {readable(summary.total_reward, DIGITS)}")
    rate_hz = summary.steps / summary.wall_s
    print_line(f"{rate_hz:.0f} steps/s, {summary.simulated_s / summary.wall_s:.1f} times real time")
    for name, one in summaries.items():
        for note in one.notes:
            print_line(f"note: {name}: {note}" if name else f"note: {note}", "yellow")


def print_measures(columns: Mapping[str, Mapping[str, Any]], title: str) -> None:
    """Print what was measured, a column for each infant by name."""
    values = {
        name: [column.get(name) for column in columns.values()]
        for name in dict.fromkeys(name for column in columns.values() for name in column)
    }
    rows = (
        (quantity_of(name).title, *map(_value, cells))
        for name, cells in values.items()
        if any(value is not None for value in cells)
    )
    print_table(("quantity", *(name or "value" for name in columns)), rows, title=title)


def _value(value: float | None) -> str:
    if value is None:
        return ""
    return ("no", "yes")[value] if isinstance(value, bool) else readable(value, DIGITS)


def print_joints(policy: object) -> None:
    """Print how each joint followed a motion, if that is what a policy did."""
    if (followed := getattr(policy, "followed", None)) is not None:
        rows = ((row[0].removeprefix("robot:"), *row[1:]) for row in followed.rows())
        print_table(followed.headings, rows, title="How each joint followed the motion")


def print_check(check: PoseCheck) -> None:
    """Print the result for a pose."""
    verdict = Text("ok    ", style="green") if check.passed else Text("failed", style="red")
    warnings = ", ".join(check.warnings) or "no warnings"
    limits = "no joint limit exceeded"
    if check.joint:
        limits = f"joint limits exceeded by at most {check.beyond_deg:.0f} degrees ({check.joint})"
    energy = f"kinetic energy at most {check.energy_j_per_kg:.2f} J/kg"
    open_console().print(verdict, f"{check.pose}: {warnings}, {energy}, {limits}")


def print_explanation(explanation: Explanation, legend: str) -> None:
    """Print the provenance of a number as a tree, and below it what its marks mean."""
    open_console().print(_branch(explanation))
    if legend:
        print_line(legend)


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
