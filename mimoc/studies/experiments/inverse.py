"""Reaching and looking by inverse dynamics, with three sets of gains (López et al. 2025, figure 5)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import pairwise
from pathlib import Path

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.compiler import pipeline
from mimoc.policies.control import GAIN_SETS
from mimoc.policies.reach import ReachErrors, reach_errors
from mimoc.render.plots.plot import Band, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.names import Development
from mimoc.studies.experiments.notebook import Cell, Measured, Notebook, child, markdown_table, table_rows, yes

AGE_MONTHS = 18
TRIALS, QUICK_TRIALS = 10, 3  # Number of trials for each set of gains; the paper shows the mean of ten.
SECONDS, QUICK_SECONDS = 2.0, 1.0
SEED = 1  # Seed of the targets, which are the same for all gains.
REACHED_MM, ALIGNED_DEG = 5.0, 2.0
"""Mean errors at the end below which hands have reached their targets, and eyes look at them."""
REPORTED_S = (0.25, 0.5, 1.0, 2.0)  # Times at which the table reports errors.

HANDS = Quantity("hands_mm", "Distance of hands from targets", "mm")
EYES = Quantity("eyes_deg", "Misalignment of eyes", "degrees")
STATISTICS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "mean": lambda errors: errors.mean(axis=0),
    "median": lambda errors: np.percentile(errors, 50.0, axis=0),
    "quartile1": lambda errors: np.percentile(errors, 25.0, axis=0),
    "quartile3": lambda errors: np.percentile(errors, 75.0, axis=0),
}
"""Statistics of errors, shape (n, t + 1), at each time, shape (t + 1,)."""
Errors = Mapping[str, FloatArray]
"""Errors of all hands, or of all eyes, in all trials, shape (n, t + 1), by set of gains."""


def run(notebook: Notebook) -> Path:
    """Let an infant reach with each set of gains, and return the path of the report."""
    trials, seconds = (QUICK_TRIALS, QUICK_SECONDS) if notebook.quick else (TRIALS, SECONDS)
    bundle, reaches = sitting(notebook.law), dict[str, ReachErrors]()
    for number, (name, gains) in enumerate(GAIN_SETS.items()):
        progress = notebook.part(number * trials, trials, len(GAIN_SETS) * trials)
        with closing(InfantEnv(bundle)) as env:
            generator = np.random.default_rng(SEED)
            reaches[name] = reach_errors(env, gains, generator, trials=trials, seconds=seconds, progress=progress)
    time_s = next(iter(reaches.values())).time_s
    hands_mm = {name: _all_limbs(1000 * reach.hands_m) for name, reach in reaches.items()}
    eyes_deg = {name: _all_limbs(np.degrees(reach.eyes_rad)) for name, reach in reaches.items()}
    columns = (f"{quantity.name}_{statistic}" for quantity in (HANDS, EYES) for statistic in STATISTICS)
    notebook.write_table("inverse.csv", ",".join(("gains", "time_s", *columns)), _rows(time_s, hands_mm, eyes_deg))
    plots = [_plot(HANDS, "Hands", time_s, hands_mm), _plot(EYES, "Eyes", time_s, eyes_deg)]
    notebook.write_plots("inverse.png", plots)
    halfway_mm = [np.median(errors[:, len(time_s) // 4]) for errors in hands_mm.values()]
    faster = all(larger < smaller for smaller, larger in pairwise(halfway_mm))
    numbers = (
        (name, *(number for gain in (it.hands, it.eyes) for number in (gain.strength, gain.viscosity_per_s)))
        for name, it in GAIN_SETS.items()
    )
    return notebook.write_page(
        _measured(hands_mm, eyes_deg, faster, trials),
        age=AGE_MONTHS,
        trials=trials,
        gains=table_rows((name, *(f"{number:g}" for number in row)) for name, *row in numbers),
        table=_table(time_s, hands_mm, eyes_deg),
        make="make" if faster else "do not always make",
        seed=SEED,
    )


def infants(law: Development) -> Iterator[Bundle]:
    """Yield the infant that reaches."""
    yield sitting(law)


def sitting(development: Development) -> Bundle:
    """Return an infant that sits with its trunk held."""
    actuation, scene = {"locked": ["trunk"]}, {"kind": "flat", "pose": "sitting", "held": ["hip"]}
    return pipeline.build(child("reaching", AGE_MONTHS, development=development, actuation=actuation, scene=scene))


def _all_limbs(errors: FloatArray) -> FloatArray:
    return np.concatenate(list(np.moveaxis(errors, 2, 0)))


def _plot(quantity: Quantity, title: str, time_s: FloatArray, errors_by_gains: Errors) -> Plot:
    lines, bands = [], []
    for name, errors in errors_by_gains.items():
        values, label = {how: statistic(errors) for how, statistic in STATISTICS.items()}, f"{name} gains"
        lines.append(Line(time_s, values["mean"], label))
        bands.append(Band(time_s, values["quartile1"], values["quartile3"], label))
    return Plot(Quantity("time_s", "Time", "s"), quantity, tuple(lines), tuple(bands), title=title)


def _rows(time_s: FloatArray, *both: Errors) -> Iterator[Sequence[Cell]]:
    for name in GAIN_SETS:
        columns = [statistic(errors[name]) for errors in both for statistic in STATISTICS.values()]
        for numbers in zip(time_s, *columns, strict=True):
            yield name, *numbers


def _table(time_s: FloatArray, *both: Errors) -> str:
    indices = {at_s: int(np.argmin(np.abs(time_s - at_s))) for at_s in REPORTED_S if at_s <= time_s[-1] + 1e-9}
    headings = ("gains", *(f"{what} at {at_s:g} s" for what in ("hands [mm]", "eyes [deg]") for at_s in indices))
    rows = [
        (name, *(_average(errors[name][:, index]) for errors in both for index in indices.values()))
        for name in GAIN_SETS
    ]
    return markdown_table(headings, rows)


def _measured(hands_mm: Errors, eyes_deg: Errors, faster: bool, trials: int) -> Measured:
    *_, largest = GAIN_SETS
    arrived = hands_mm[largest][:, -1].mean() < REACHED_MM and eyes_deg[largest][:, -1].mean() < ALIGNED_DEG
    return {
        "hands reach their targets while eyes align": yes(bool(arrived)),
        "larger gains make hands faster": yes(faster),
        "number of random targets": trials,
        "number of sets of gains": len(GAIN_SETS),
    }


def _average(errors: FloatArray) -> str:
    return f"{errors.mean():.1f} ({np.median(errors):.1f})"
