"""Console output of measures of movement."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from mimoc.base.errors import counted
from mimoc.base.quantities import QUANTITIES
from mimoc.base.quantities.movement import CORE
from mimoc.base.rounding import readable
from mimoc.cli.console import new_table, open_console
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mimoc.movement.report import MovementMeasures, Spread

FAR_SD = 2.0
"""Scores beyond it are marked."""
SD_DIGITS = 2


def print_movement(measured: MovementMeasures, full: bool) -> None:
    """Print the measures of infants, of each side if sides differ, beside counterparts and the sample, if any."""
    console = open_console()
    core = {quantity.name for quantity in CORE}
    scores, sample = measured.scores, measured.sample
    count = len(measured.infants)
    who, what = (counted(count, "infant"), "mean") if count > 1 else (printable(measured.names[0]), "value")
    title = f"{who}: {what} ± SD between {measured.spread_is_over} (n)"
    columns = {what: _cells(measured.means, measured.spreads), **_columns(measured)}
    table = new_table("measure", *columns, *(["sample", "z"] if sample else []), title=title)
    for name in measured.means:
        if name not in core and not full:
            continue
        row: list[str | Text] = [QUANTITIES[name].title, *(cells.get(name, "") for cells in columns.values())]
        if sample and name in sample.means:
            row += [_cell(sample.means[name], sample.deviations[name], sample.infants), _score(scores[name])]
        table.add_row(*row)
    console.print(table)
    if sample:
        _print_comparison(measured)
    for note in measured.notes:
        console.print(Text(f"note: {printable(note)}", style="yellow"))


def _columns(measured: MovementMeasures) -> dict[str, dict[str, str]]:
    """Return what stands beside the means, by heading: each side if it differs, and the same of counterparts."""
    shows_sides = any(one.sides_differ for one in (measured, *measured.beside.values()))
    columns = {}
    for name, one in {"": measured, **measured.beside}.items():
        if name:
            columns[name] = _cells(one.means, one.spreads)
        for side, means in one.side_means.items() if shows_sides else ():
            columns[f"{name} {side}".strip()] = _cells(means, one.side_spreads[side])
    return columns


def _cells(means: Mapping[str, float], spreads: Mapping[str, Spread]) -> dict[str, str]:
    return {name: _cell(value, spreads[name].sd, spreads[name].n) for name, value in means.items()}


def _cell(mean: float, sd: float | None, n: int) -> str:
    return f"{readable(mean)} ± {'-' if sd is None else readable(sd, SD_DIGITS)} ({n})"


def _score(score: float) -> Text:
    far = abs(score) > FAR_SD
    return Text(f"{score:+.1f}{'*' if far else ' '}", style="yellow" if far else "")


def _print_comparison(measured: MovementMeasures) -> None:
    from mimoc.movement.real_infants import DISTANCES, DRAWS, NAME

    console, sample = open_console(), measured.sample
    if sample is None or measured.distance is None:
        return
    several = len(measured.distances) > 1
    each = sorted(measured.distances if several else measured.window_distances)
    what = "each" if several else measured.spread_is_over
    of_all = f", of {what} {each[0]:.2f} to {each[-1]:.2f} (n {len(each)})" if each else ""
    real = f" (a real infant to the other 11: {DISTANCES[0]} to {DISTANCES[2]})" if sample.name == NAME else ""
    mean = " of the mean" if several else ""
    console.print(f"distance{mean} to {printable(sample.name)}: {measured.distance:.2f}{of_all}{real}")
    if apart := measured.apart:
        about, spread = ("", "standard error") if apart.exact else ("about ", f"SD over {DRAWS} draws of real infants")
        figure = f"{about}{apart.accuracy:.2f} ± {apart.deviation:.2f} ({spread}; {counted(apart.windows, 'window')})"
        console.print(f"told apart in windows of 8 s: {figure}; .5 is chance, 1 is always")
