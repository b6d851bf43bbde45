"""Reaching and looking by inverse dynamics, with three sets of gains (López et al. 2025, figure 5)."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from itertools import pairwise
from pathlib import Path

import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.compiler import pipeline
from mimoc.control import GAIN_SETS, ReachGains
from mimoc.policies.reach import ReachErrors, reach_errors
from mimoc.quantities import Quantity
from mimoc.render.plots.plot import Band, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.senses.sense import FloatArray
from mimoc.studies.experiments.notebook import Notebook, markdown_table, page_texts

AGE_MONTHS = 18
TRIALS, QUICK_TRIALS = 10, 3
"""Number of trials for each set of gains; the paper shows the mean of ten."""
SECONDS, QUICK_SECONDS = 2.0, 1.0
SEED = 1
"""Seed of the targets, which are the same for all gains."""
REPORTED_S = (0.25, 0.5, 1.0, 2.0)
"""Times at which the table reports errors."""

TEXTS = page_texts("inverse")


def run(notebook: Notebook) -> Path:
    """Let an infant reach with each set of gains, and return the path of the report."""
    trials, seconds = (QUICK_TRIALS, QUICK_SECONDS) if notebook.quick else (TRIALS, SECONDS)
    errors = dict(_reaches(notebook, trials, seconds))
    notebook.write_table(
        "inverse.csv",
        ("gains", "time_s", *(f"{what}_{how}" for what in ("hands_mm", "eyes_deg") for how in HOW)),
        _rows(errors),
    )
    hands = Quantity("hands_mm", "Distance of hands from targets", "mm")
    eyes = Quantity("eyes_deg", "Misalignment of eyes", "degrees")
    plots = [_plot(hands, "Hands", errors, _hands_mm), _plot(eyes, "Eyes", errors, _eyes_deg)]
    notebook.write_plots("inverse.png", plots)
    about = TEXTS["about"].format(age=AGE_MONTHS, trials=trials, gains=_gains_table())
    compared = TEXTS["compared"].format(table=_table(errors), verdict=_verdict(errors))
    return notebook.write_page(
        "Inverse dynamics", (about, compared), seeds=f"Seed of the targets: {SEED}.", libraries=["matplotlib"]
    )


HOW: Mapping[str, float | None] = {"mean": None, "median": 50.0, "quartile1": 25.0, "quartile3": 75.0}
"""Statistics of the errors: a percentile, or None for the mean."""


def _reaches(notebook: Notebook, trials: int, seconds: float) -> Iterator[tuple[str, ReachErrors]]:
    """Yield the errors of reaching with each set of gains."""
    bundle = sitting()
    for number, (name, gains) in enumerate(GAIN_SETS.items()):

        def report(done: int, total: int, before: int = number * trials) -> None:
            notebook.progress(before + done, len(GAIN_SETS) * trials)

        with closing(InfantEnv(bundle)) as env:
            generator = np.random.default_rng(SEED)
            yield name, reach_errors(env, gains, generator, trials=trials, seconds=seconds, progress=report)


def sitting() -> Bundle:
    """Return an infant by the paper's law that sits with its trunk held."""
    spec = {
        "mimoc": 1,
        "name": "reaching",
        "age_months": AGE_MONTHS,
        "development": "published",
        "actuation": {"locked": ["trunk"]},
        "scene": {"kind": "flat", "pose": "sitting", "held": ["hip"]},
    }
    return pipeline.build(InfantSpec.model_validate(spec))


def _hands_mm(errors: ReachErrors) -> FloatArray:
    """Return the distance of all hands in all trials, shape (n, t + 1)."""
    return 1000 * np.concatenate(list(np.moveaxis(errors.hands_m, 2, 0)))


def _eyes_deg(errors: ReachErrors) -> FloatArray:
    """Return the misalignment of all eyes in all trials, shape (n, t + 1)."""
    return np.degrees(np.concatenate(list(np.moveaxis(errors.eyes_rad, 2, 0))))


def _statistic(errors: FloatArray, percentile: float | None) -> FloatArray:
    """Return the mean or a percentile at each time, shape (t + 1,)."""
    return errors.mean(axis=0) if percentile is None else np.percentile(errors, percentile, axis=0)


def _plot(
    quantity: Quantity,
    title: str,
    errors_by_gains: Mapping[str, ReachErrors],
    pick: Callable[[ReachErrors], FloatArray],
) -> Plot:
    lines, bands = [], []
    for name, errors in errors_by_gains.items():
        values, label = pick(errors), f"{name} gains"
        lines.append(Line(errors.time_s, _statistic(values, None), label))
        bands.append(Band(errors.time_s, _statistic(values, 25.0), _statistic(values, 75.0), label))
    return Plot(Quantity("time_s", "Time", "s"), quantity, tuple(lines), tuple(bands), title=title)


def _rows(errors_by_gains: Mapping[str, ReachErrors]) -> Iterator[tuple[str | float, ...]]:
    for name, errors in errors_by_gains.items():
        columns = [
            _statistic(values, percentile)
            for values in (_hands_mm(errors), _eyes_deg(errors))
            for percentile in HOW.values()
        ]
        for index, time_s in enumerate(errors.time_s.tolist()):
            yield name, time_s, *(float(column[index]) for column in columns)


def _gains_table() -> str:
    headings = ("gains", "hands [1/s²]", "viscosity [1/s]", "eyes [1/s²]", "viscosity [1/s]")
    return markdown_table(headings, (_gains_row(name, gains) for name, gains in GAIN_SETS.items()))


def _gains_row(name: str, gains: ReachGains) -> tuple[str, ...]:
    numbers = (gains.hands.strength, gains.hands.viscosity_per_s, gains.eyes.strength, gains.eyes.viscosity_per_s)
    return name, *(f"{number:g}" for number in numbers)


def _table(errors_by_gains: Mapping[str, ReachErrors]) -> str:
    times_s = [time_s for time_s in REPORTED_S if time_s <= next(iter(errors_by_gains.values())).time_s[-1] + 1e-9]
    headings = ("gains", *(f"{what} at {time_s:g} s" for what in ("hands [mm]", "eyes [deg]") for time_s in times_s))
    rows = [
        (name, *(_at(errors, pick(errors), time_s) for pick in (_hands_mm, _eyes_deg) for time_s in times_s))
        for name, errors in errors_by_gains.items()
    ]
    return markdown_table(headings, rows)


def _at(errors: ReachErrors, values: FloatArray, time_s: float) -> str:
    index = int(np.argmin(np.abs(errors.time_s - time_s)))
    return f"{values[:, index].mean():.1f} ({np.median(values[:, index]):.1f})"


def _verdict(errors_by_gains: Mapping[str, ReachErrors]) -> str:
    """Return as text whether larger gains make reaching faster, by the median distance at half a second."""
    distances_mm = [np.median(_hands_mm(errors)[:, len(errors.time_s) // 4]) for errors in errors_by_gains.values()]
    faster = all(larger < smaller for smaller, larger in pairwise(distances_mm))
    return f"Larger gains {'make' if faster else 'do not always make'} the hands reach their targets sooner."
