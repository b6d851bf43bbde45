"""Reaching and looking by inverse dynamics, with three sets of gains (López et al. 2025, figure 5)."""

from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.compiler import building
from mimoc.policies.reach import GAIN_SETS, ReachErrors, reach_errors
from mimoc.render.plots import Band, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Measured, Results, Table, child
from mimoc.studies.notebook import PAGES, Notebook, markdown_table, table_rows, yes

AGE_MONTHS = 18
TRIALS, QUICK_TRIALS = 10, 3  # Number of trials for each set of gains; the paper shows the mean of ten.
SECONDS, QUICK_SECONDS = 2.0, 1.0
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


@dataclass(frozen=True, slots=True)
class Case:
    """An infant that reaches with one of the sets of gains."""

    gains: str
    development: Development
    trials: int
    seconds: float


def cases(notebook: Notebook) -> list[Case]:
    """Return the same infant with each set of gains."""
    trials, seconds = (QUICK_TRIALS, QUICK_SECONDS) if notebook.quick else (TRIALS, SECONDS)
    return [Case(name, notebook.law, trials, seconds) for name in GAIN_SETS]


def reach(case: Case, seed: int) -> ReachErrors:
    """Let an infant reach for random targets, which are the same for all gains."""
    with closing(InfantEnv(sitting(case.development))) as env:
        generator = np.random.default_rng(seed)
        return reach_errors(env, GAIN_SETS[case.gains], generator, trials=case.trials, seconds=case.seconds)


def sitting(development: Development) -> Bundle:
    """Return an infant that sits with its trunk held."""
    actuation = {"locked": ["trunk"]}
    scene = {"kind": "flat", "pose": "sitting", "held": ["hip"]}
    return building.build(child("reaching", AGE_MONTHS, development=development, actuation=actuation, scene=scene))


def _errors(results: Results) -> tuple[FloatArray, Errors, Errors]:
    """Return times, distances of hands [mm] and misalignments of eyes [deg] of all trials and limbs."""
    reaches = {case.gains: reach for case, (reach,) in results.by_case.items()}
    time_s = next(iter(reaches.values())).time_s
    hands_mm = {name: _all_limbs(1000 * reach.hands_m) for name, reach in reaches.items()}
    return time_s, hands_mm, {name: _all_limbs(np.degrees(reach.eyes_rad)) for name, reach in reaches.items()}


def _all_limbs(errors: FloatArray) -> FloatArray:
    return np.concatenate(list(np.moveaxis(errors, 2, 0)))


def _plots(results: Results) -> list[Plot]:
    time_s, hands_mm, eyes_deg = _errors(results)
    return [_plot(HANDS, "Hands", time_s, hands_mm), _plot(EYES, "Eyes", time_s, eyes_deg)]


def _plot(quantity: Quantity, title: str, time_s: FloatArray, errors_by_gains: Errors) -> Plot:
    lines, bands = [], []
    for name, errors in errors_by_gains.items():
        values = {how: statistic(errors) for how, statistic in STATISTICS.items()}
        label = f"{name} gains"
        lines.append(Line(time_s, values["mean"], label))
        bands.append(Band(time_s, values["quartile1"], values["quartile3"], label))
    return Plot(Quantity("time_s", "Time", "s"), quantity, tuple(lines), tuple(bands), title=title)


def _csv(results: Results) -> Table:
    time_s, *both = _errors(results)
    columns = (f"{quantity.name}_{statistic}" for quantity in (HANDS, EYES) for statistic in STATISTICS)
    return ",".join(("gains", "time_s", *columns)), (
        (name, *numbers)
        for name in GAIN_SETS
        for numbers in zip(
            time_s, *(statistic(errors[name]) for errors in both for statistic in STATISTICS.values()), strict=True
        )
    )


def _is_faster(hands_mm: Errors) -> bool:
    """Return whether hands are nearer to their targets after a quarter of the time with each larger gain."""
    halfway_mm = [np.median(errors[:, errors.shape[1] // 4]) for errors in hands_mm.values()]
    return all(larger < smaller for smaller, larger in pairwise(halfway_mm))


def _numbers(results: Results) -> dict[str, object]:
    gains = (
        (name, *(number for gain in (it.hands, it.eyes) for number in (gain.strength, gain.viscosity_per_s)))
        for name, it in GAIN_SETS.items()
    )
    time_s, hands_mm, eyes_deg = _errors(results)
    return {
        "age": AGE_MONTHS,
        "trials": next(iter(results.by_case)).trials,
        "gains": table_rows((name, *(f"{number:g}" for number in row)) for name, *row in gains),
        "table": _table(time_s, hands_mm, eyes_deg),
        "make": "make" if _is_faster(hands_mm) else "do not always make",
        "seed": results.seeds[0],
    }


def _table(time_s: FloatArray, *both: Errors) -> str:
    indices = {at_s: int(np.argmin(np.abs(time_s - at_s))) for at_s in REPORTED_S if at_s <= time_s[-1] + 1e-9}
    headings = ("gains", *(f"{what} at {at_s:g} s" for what in ("hands [mm]", "eyes [deg]") for at_s in indices))
    rows = [
        (name, *(_average(errors[name][:, index]) for errors in both for index in indices.values()))
        for name in GAIN_SETS
    ]
    return markdown_table(headings, rows)


def _measured(results: Results) -> Measured:
    _, hands_mm, eyes_deg = _errors(results)
    *_, largest = GAIN_SETS
    arrived = hands_mm[largest][:, -1].mean() < REACHED_MM and eyes_deg[largest][:, -1].mean() < ALIGNED_DEG
    return {
        "hands reach their targets while eyes align": yes(bool(arrived)),
        "larger gains make hands faster": yes(_is_faster(hands_mm)),
        "number of random targets": next(iter(results.by_case)).trials,
        "number of sets of gains": len(GAIN_SETS),
    }


def _average(errors: FloatArray) -> str:
    return f"{errors.mean():.1f} ({np.median(errors):.1f})"


EXPERIMENT = Experiment(
    name="inverse",
    trial=reach,
    cases=cases,
    seeds=(1,),
    kept=False,
    files={"inverse.csv": _csv, "inverse.png": _plots},
    page=PAGES / "inverse.md",
    numbers=_numbers,
    measured=_measured,
    infants=lambda law: [sitting(law)],
    development="published",
)
