"""Learning curves of one or more trainings."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mimoc.base.quantities.outcome import LEARNING, SO_FAR, TRAINED
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
        lines, bands = [], []
        for label, seeds in curves.items():
            rows = min((len(columns["steps"]) for columns in seeds), default=0)
            if rows == 0:
                continue
            values = np.array([np.asarray(columns[quantity.curve], float)[:rows] for columns in seeds])
            known = np.isfinite(values).any(axis=0)
            steps, values = np.asarray(seeds[0]["steps"], float)[:rows][known], values[:, known]
            lines.append(Line(steps, np.nanmean(values, axis=0), label, "marked" if len(steps) == 1 else "line"))
            if len(seeds) > 1:
                bands.append(Band(steps, np.nanmin(values, axis=0), np.nanmax(values, axis=0), label))
        if len(drawn) == 1 and quantity in SO_FAR:
            so_far = np.asarray(drawn[0].get(SO_FAR[quantity].curve, ()), float)
            if np.isfinite(so_far).any():
                lines.append(Line(drawn[0]["steps"], so_far, "so far, of unfinished episodes", "so-far"))
        plot = Plot(TRAINED, quantity, tuple(lines), tuple(bands), x_range=(0, 1.02 * last))
        if levels and quantity.curve in levels:
            plot = replace(plot, level=levels[quantity.curve], level_label=level)
        plots.append(plot)
    return Sheet(tuple(plots), columns=2, panel_px=(800, 520), shared_legend=True)
