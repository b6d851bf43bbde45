"""Learning curves of one or more trainings."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mimoc.quantities import Quantity
from mimoc.quantities.outcome import LEARNING, SO_FAR, TRAINED
from mimoc.render.plots.plot import Band, Line, Plot, Sheet

Columns = Mapping[str, Sequence[float] | np.ndarray]
"""Columns of a learning curve by name, all of the same length, including `steps`."""


def learning_sheet(
    curves: Mapping[str, Sequence[Columns]], levels: Mapping[str, float] | None = None, level: str = "random policy"
) -> Sheet:
    """Return plots of learning curves, one for each quantity, with *levels* to compare with, by column.

    Of the seeds of a label, the line is their mean, the band their range. A single curve is drawn with what there is so
    far of episodes that have not ended.
    """
    drawn = [columns for seeds in curves.values() for columns in seeds]
    last = max((max(columns["steps"], default=1) for columns in drawn), default=1)
    plots = []
    for quantity in LEARNING:
        parts = [part for label, seeds in curves.items() for part in _mean_and_range(seeds, quantity, label)]
        lines = [part for part in parts if isinstance(part, Line)]
        lines += _unfinished(drawn[0], quantity) if len(drawn) == 1 else []
        bands = tuple(part for part in parts if isinstance(part, Band))
        plot = Plot(TRAINED, quantity, tuple(lines), bands, x_range=(0, 1.02 * last))
        if levels and quantity.curve in levels:
            plot = replace(plot, level=levels[quantity.curve], level_label=level)
        plots.append(plot)
    return Sheet(tuple(plots), columns=2, panel_px=(800, 520), shared_legend=True)


def _mean_and_range(seeds: Sequence[Columns], quantity: Quantity, label: str) -> list[Line | Band]:
    """Return mean and range over the seeds, ignoring NaN."""
    rows = min((len(columns["steps"]) for columns in seeds), default=0)
    if rows == 0:
        return []
    steps = np.asarray(seeds[0]["steps"], float)[:rows]
    values = np.array([np.asarray(columns[quantity.curve], float)[:rows] for columns in seeds])
    known = np.isfinite(values).any(axis=0)
    steps, values = steps[known], values[:, known]
    band = Band(steps, np.nanmin(values, axis=0), np.nanmax(values, axis=0), label)
    line = Line(steps, np.nanmean(values, axis=0), label, "marked" if len(steps) == 1 else "line")
    return [line, *([band] if len(seeds) > 1 else [])]


def _unfinished(columns: Columns, quantity: Quantity) -> list[Line]:
    values = np.asarray(columns.get(SO_FAR[quantity].curve, ()) if quantity in SO_FAR else (), float)
    label = "so far, of unfinished episodes"
    return [Line(columns["steps"], values, label, "so-far")] if np.isfinite(values).any() else []
