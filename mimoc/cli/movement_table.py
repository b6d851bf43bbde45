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
    """Print the measures of infants, of each side if sides differ, beside counterparts and the sample, if any."""
    console = open_console()
    core = {quantity.name for quantity in CORE}
    means, scores, sample = measured.means, measured.scores, measured.sample
    count = len(measured.infants)
    title = counted(count, "infant") if count > 1 else printable(measured.names[0])
    columns = _columns(measured)
    headings = ["measure", "value" if count == 1 else "mean", *columns, *(["sample", "SD", "z"] if sample else [])]
    table = new_table(*headings, title=title)
    for name, value in means.items():
        if name not in core and not full:
            continue
        others = (f"{values[name]:.3g}" if name in values else "" for values in columns.values())
        row = [QUANTITIES[name].title, f"{value:.3g}", *others]
        if sample and name in sample.means:
            row += [f"{sample.means[name]:.3g}", f"{sample.deviations[name]:.2g}", _score(scores[name])]
        table.add_row(*row)
    console.print(table)
    if sample:
        _print_comparison(measured)
    for note in measured.notes:
        console.print(Text(f"note: {printable(note)}", style="yellow"))


def _columns(measured: MovementMeasures) -> dict[str, dict[str, float]]:
    """Return what stands beside the means, by heading: each side if it differs, and the same of counterparts."""
    shows_sides = any(one.sides_differ for one in (measured, *measured.beside.values()))
    columns = dict(measured.side_means) if shows_sides else {}
    for name, other in measured.beside.items():
        sides = other.side_means if shows_sides else {}
        columns |= {name: other.means} | {f"{name} {side}": means for side, means in sides.items()}
    return columns


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
