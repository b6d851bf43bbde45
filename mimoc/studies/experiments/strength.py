"""Strength from birth to two years: lifting the head and a leg (López et al. 2025, figure 2 d-e)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimoc.body import grow_body
from mimoc.quantities import Quantity
from mimoc.render.plots.plot import Line, Plot
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments import strength_page
from mimoc.studies.experiments.effort import BEHAVIOURS, Behaviour, Effort, Model, efforts
from mimoc.studies.experiments.notebook import Cell, Notebook, Progress
from mimoc.studies.experiments.strength_page import FULL_SIZE_MONTHS, TARGET_DEG, Findings

PAPER_MONTHS: Sequence[float] = (0, 3, 6, 9, 12, 18, 24)
MONTHS: Sequence[float] = range(25)
REFERENCE_S: Mapping[str, Mapping[float, float]] = {
    "head lift": {0.75: 2.25, 0.85: 1.20, 1.0: 0.72},
    "leg lift": {0.62: 1.79, 0.75: 0.58, 0.85: 0.37, 1.0: 0.25},
}
"""Time that the published infant takes to reach 60 degrees, by relative size."""

HEADINGS = (
    "behaviour",
    "age_months",
    "strength_age_months",
    "length_cm",
    "start_deg",
    "peak_deg",
    "peak_in_range_deg",
    "time_to_60_deg_s",
)
CURVE_HEADINGS = ("behaviour", "age_months", "time_s", "angle_deg")


@dataclass(frozen=True, slots=True)
class Trial:
    """An infant that performs all behaviours in turn."""

    age_months: float
    model: Model = "torque"
    strength_age_months: float | None = None


def run(notebook: Notebook) -> Path:
    """Let infants of many ages lift the head and a leg, and return the path of the report."""
    by_age = [Trial(age) for age in (PAPER_MONTHS if notebook.quick else MONTHS)]
    by_size = {(each, size): Trial(age_of(each, size)) for each in BEHAVIOURS for size in REFERENCE_S[each.name]}
    muscles = [Trial(age, "muscle", strength) for strength in (None, FULL_SIZE_MONTHS) for age in PAPER_MONTHS]
    found = _run_all([*by_age, *by_size.values(), *muscles], notebook.progress)
    torque = [effort for trial in by_age for effort in found[trial]]
    muscle = [effort for trial in muscles for effort in found[trial]]
    shown = [effort for effort in torque if effort.age_months in PAPER_MONTHS]
    notebook.write_table("strength.csv", HEADINGS, map(_summary, torque))
    notebook.write_table("muscles.csv", HEADINGS, map(_summary, muscle))
    notebook.write_table("curves.csv", CURVE_HEADINGS, _samples(shown))
    notebook.write_plots("strength.png", [_plot(shown, each) for each in BEHAVIOURS])
    sized = [
        (size, REFERENCE_S[each.name][size], effort)
        for (each, size), trial in by_size.items()
        for effort in found[trial]
        if effort.behaviour == each
    ]
    return strength_page.write(notebook, Findings(torque, shown, sized, muscle))


def age_of(behaviour: Behaviour, size: float) -> float:
    """Return the age, in months, at which the body part moved by a behaviour has a relative size.

    The relative size is the cube root of the part's volume relative to that at 18 months; strength is proportional to
    the volume.
    """
    strengths_nm = [_strength_nm(behaviour, age_months) for age_months in MONTHS]
    sizes = np.cbrt(np.divide(strengths_nm, _strength_nm(behaviour, FULL_SIZE_MONTHS)))
    return round(float(np.interp(size, sizes, MONTHS)), 3)


def _strength_nm(behaviour: Behaviour, age_months: float) -> float:
    spec = InfantSpec(mimoc=1, name="lying", age_months=age_months, development="published")
    return next(motor.gear_nm for motor in grow_body(spec).tree.motors if motor.name == behaviour.actuator)


def _run_all(trials: Sequence[Trial], progress: Progress) -> Mapping[Trial, list[Effort]]:
    found: dict[Trial, list[Effort]] = {}
    for done, trial in enumerate(trials, start=1):
        if trial not in found:
            found[trial] = list(efforts(trial.age_months, trial.model, trial.strength_age_months))
        progress(done, len(trials))
    return found


def _summary(effort: Effort) -> tuple[Cell, ...]:
    return (
        effort.behaviour.name,
        effort.age_months,
        effort.strength_age_months,
        effort.length_cm,
        effort.angle_deg[0],
        effort.peak_deg,
        effort.peak_in_range_deg,
        effort.time_to_s(TARGET_DEG),
    )


def _samples(found: Iterable[Effort]) -> Iterator[tuple[Cell, ...]]:
    for effort in found:
        for time_s, angle_deg in zip(effort.time_s, effort.angle_deg, strict=True):
            yield effort.behaviour.name, effort.age_months, time_s, angle_deg


def _plot(found: Iterable[Effort], behaviour: Behaviour) -> Plot:
    return Plot(
        x=Quantity("time_s", "Time", "s"),
        y=Quantity("angle_deg", "Angle", "deg"),
        lines=tuple(
            Line(effort.time_s, effort.angle_deg, f"{effort.age_months:g} months")
            for effort in found
            if effort.behaviour == behaviour
        ),
        title=behaviour.name.capitalize(),
        level=TARGET_DEG,
    )
