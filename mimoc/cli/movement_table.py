"""Console output of measures of movement."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from mimoc.base.errors import counted
from mimoc.cli.console import new_table, open_console
from mimoc.cli.terminal import printable
from mimoc.quantities import QUANTITIES
from mimoc.quantities.movement import CORE

if TYPE_CHECKING:
    from mimoc.movement.report import MovementMeasures

FAR_SD = 2.0
"""Scores beyond it are marked."""


def print_movement(measured: MovementMeasures, full: bool) -> None:
    """Print the measures of infants, beside those of the sample that they are compared with, if there is one."""
    console = open_console()
    core = {quantity.name for quantity in CORE}
    means, scores, sample = measured.means, measured.scores, measured.sample
    count = len(measured.infants)
    title = counted(count, "infant") if count > 1 else printable(measured.names[0])
    headings = ["measure", "value" if count == 1 else "mean", *(["sample", "SD", "z"] if sample else [])]
    table = new_table(*headings, title=title)
    for name, value in means.items():
        if name not in core and not full:
            continue
        row = [QUANTITIES[name].title, f"{value:.3g}"]
        if sample and name in sample.means:
            row += [f"{sample.means[name]:.3g}", f"{sample.deviations[name]:.2g}", _score(scores[name])]
        table.add_row(*row)
    console.print(table)
    if sample:
        _print_comparison(measured)
    for note in measured.notes:
        console.print(Text(f"note: {printable(note)}", style="yellow"))


def _score(score: float) -> Text:
    far = abs(score) > FAR_SD
    return Text(f"{score:+.1f}{'*' if far else ' '}", style="yellow" if far else "")


def _print_comparison(measured: MovementMeasures) -> None:
    from mimoc.movement.real_infants import DISTANCES, NAME

    console, sample, distances = open_console(), measured.sample, sorted(measured.distances)
    if sample is None or measured.distance is None:
        return
    of_all = f", of each {distances[0]:.2f} to {distances[-1]:.2f}" if len(distances) > 1 else ""
    real = f" (a real infant to the other 11: {DISTANCES[0]} to {DISTANCES[2]})" if sample.name == NAME else ""
    mean = " of the mean" if len(distances) > 1 else ""
    console.print(f"distance{mean} to {printable(sample.name)}: {measured.distance:.2f}{of_all}{real}")
    if measured.apart:
        about = "" if measured.apart.exact else "about "
        console.print(f"told apart in windows of 8 s: {about}{measured.apart.accuracy:.2f} (.5 is chance, 1 is always)")
