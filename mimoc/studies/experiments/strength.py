"""Strength from birth to two years: lifting the head and a leg (López et al. 2025, figure 2 d-e)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.body.grow import grow_body
from mimoc.quantities import Quantity
from mimoc.render.plots.plot import Line, Plot
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments.effort import (
    BEHAVIOURS,
    SETTLING_STEPS,
    STEP_MS,
    STEPS,
    Behaviour,
    Effort,
    Model,
    efforts,
)
from mimoc.studies.experiments.notebook import Cell, Notebook, Progress, markdown_table, page_texts

TARGET_DEG = 60.0
FULL_SIZE_MONTHS = 18
"""The age at which a part's relative size is 1."""
LAW_MONTHS = 3
"""Age from which on the time is compared; a newborn does not reach 60 degrees."""


@dataclass(frozen=True, slots=True)
class Findings:
    """The measurements, youngest first."""

    torque: Sequence[Effort]
    """Torque actuation, at all ages."""
    shown: Sequence[Effort]
    """Those of them at the paper's ages."""
    sized: Sequence[tuple[float, float, Effort]]
    """Relative size, the published infant's time in [s], and the child whose body part has that size."""
    muscle: Sequence[Effort]
    """Muscle actuation at the paper's ages, with the strength of the age and with that of 18 months."""


TEXTS = page_texts("strength")


def _write_page(notebook: Notebook, findings: Findings) -> Path:
    """Write the report, and return its path."""
    overshoot_deg = max(effort.peak_deg - effort.end_deg for effort in findings.torque)
    head_deg, leg_deg = (_of(findings.torque, behaviour)[0].end_deg for behaviour in BEHAVIOURS)
    about = TEXTS["about"].format(
        settling_s=SETTLING_STEPS * ms_to_s(STEP_MS),
        steps=STEPS,
        step_ms=STEP_MS,
        head_end=head_deg,
        leg_end=leg_deg,
        overshoot=overshoot_deg,
    )
    compared = TEXTS["compared"].format(
        laws="\n".join(f"- {law}" for law in _laws(findings)),
        ages=_ages_table(findings.shown),
        target_deg=TARGET_DEG,
        full_size=FULL_SIZE_MONTHS,
        order=_order_table(findings.sized),
    )
    muscles = TEXTS["muscles"].format(
        table=_muscle_table(findings.muscle), full_size=FULL_SIZE_MONTHS, target_deg=TARGET_DEG
    )
    sections = (about, compared, muscles)
    return notebook.write_page("Strength", sections, seeds="Nothing is random.", libraries=["matplotlib"])


def is_faster_with_age(efforts: Iterable[Effort], within_s: float = 0.0) -> bool:
    """Return whether the time to 60 degrees decreases from each age to the next, from three months on.

    Args:
        efforts: Measurements, youngest first.
        within_s: Increases below this are ignored.
    """
    times_s = [effort.time_to_s(TARGET_DEG) for effort in efforts if effort.age_months >= LAW_MONTHS]
    return all(a is not None and b is not None and a + within_s > b for a, b in pairwise(times_s))


def gets_as_far_with_age(efforts: Iterable[Effort]) -> bool:
    """Return whether the peak angle, clipped to the joint range, never decreases with age."""
    return all(a.peak_in_range_deg <= b.peak_in_range_deg for a, b in pairwise(efforts))


def _laws(findings: Findings) -> list[str]:
    """Return as sentences which laws hold for each behaviour and which do not."""
    laws = []
    for behaviour in BEHAVIOURS:
        name = behaviour.name.capitalize()
        every, shown = _of(findings.torque, behaviour), _of(findings.shown, behaviour)
        faster = "decreases" if is_faster_with_age(shown) else "does NOT always decrease"
        steadily = "never" if is_faster_with_age(every, ms_to_s(STEP_MS)) else "sometimes"
        as_far = "never decreases" if gets_as_far_with_age(every) else "DOES decrease"
        laws += [
            f"{name}, time to {TARGET_DEG:g} degrees: from {LAW_MONTHS} months on, it {faster} from each age in the"
            " table to the next;",
            f"{name}, the same over all ages in `strength.csv`: it {steadily} increases by a control step or more;",
            f"{name}, peak angle within the joint range: it {as_far} with age, from birth on.",
        ]
    return laws


def _of(efforts: Iterable[Effort], behaviour: Behaviour) -> list[Effort]:
    return [effort for effort in efforts if effort.behaviour == behaviour]


def _ages_table(shown: Sequence[Effort]) -> str:
    headings = [
        "months",
        *(f"{behaviour.name}, {what}" for behaviour in BEHAVIOURS for what in ("s to 60°", "peak [deg]")),
    ]
    pairs = zip(*(_of(shown, behaviour) for behaviour in BEHAVIOURS), strict=True)
    return markdown_table(
        headings,
        (
            [f"{pair[0].age_months:g}", *(text for effort in pair for text in (_time(effort), _peak(effort)))]
            for pair in pairs
        ),
    )


def _order_table(sized: Sequence[tuple[float, float, Effort]]) -> str:
    headings = ("behaviour", "size", "paper, s to 60°", "mimoc, s to 60°", "at months")
    rows = (
        (effort.behaviour.name, f"{size:g}", f"{paper_s:.2f}", _time(effort), f"{effort.age_months:.1f}")
        for size, paper_s, effort in sized
    )
    return markdown_table(headings, rows)


def _muscle_table(muscle: Sequence[Effort]) -> str:
    grown, constant = (
        [effort for effort in muscle if (effort.strength_age_months == effort.age_months) == grows]
        for grows in (True, False)
    )
    at_full_size = [effort for effort in grown if effort.age_months == FULL_SIZE_MONTHS]
    headings = ["months", *(f"{behaviour.name}{also}" for also in ("", ", strength of 18") for behaviour in BEHAVIOURS)]
    times = {
        (effort.age_months, kind, effort.behaviour): _time(effort)
        for kind, efforts in (("grown", grown), ("constant", [*constant, *at_full_size]))
        for effort in efforts
    }
    ages = dict.fromkeys(age for age, _, _ in times)
    return markdown_table(
        headings,
        (
            [f"{age:g}", *(times[age, kind, behaviour] for kind in ("grown", "constant") for behaviour in BEHAVIOURS)]
            for age in sorted(ages)
        ),
    )


def _time(effort: Effort) -> str:
    time_s = effort.time_to_s(TARGET_DEG)
    return "never" if time_s is None else f"{time_s:.2f}"


def _peak(effort: Effort) -> str:
    return f"{effort.peak_deg:.1f}"


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
    by_size = {(item, size): Trial(age_of(item, size)) for item in BEHAVIOURS for size in REFERENCE_S[item.name]}
    muscles = [Trial(age, "muscle", strength) for strength in (None, FULL_SIZE_MONTHS) for age in PAPER_MONTHS]
    results = _run_all([*by_age, *by_size.values(), *muscles], notebook.progress)
    torque = [effort for trial in by_age for effort in results[trial]]
    muscle = [effort for trial in muscles for effort in results[trial]]
    shown = [effort for effort in torque if effort.age_months in PAPER_MONTHS]
    notebook.write_table("strength.csv", HEADINGS, map(_summary, torque))
    notebook.write_table("muscles.csv", HEADINGS, map(_summary, muscle))
    notebook.write_table("curves.csv", CURVE_HEADINGS, _samples(shown))
    notebook.write_plots("strength.png", [_plot(shown, item) for item in BEHAVIOURS])
    sized = [
        (size, REFERENCE_S[item.name][size], effort)
        for (item, size), trial in by_size.items()
        for effort in results[trial]
        if effort.behaviour == item
    ]
    return _write_page(notebook, Findings(torque, shown, sized, muscle))


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
    results: dict[Trial, list[Effort]] = {}
    for done, trial in enumerate(trials, start=1):
        if trial not in results:
            results[trial] = list(efforts(trial.age_months, trial.model, trial.strength_age_months))
        progress(done, len(trials))
    return results


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


def _samples(results: Iterable[Effort]) -> Iterator[tuple[Cell, ...]]:
    for effort in results:
        for time_s, angle_deg in zip(effort.time_s, effort.angle_deg, strict=True):
            yield effort.behaviour.name, effort.age_months, time_s, angle_deg


def _plot(results: Iterable[Effort], behaviour: Behaviour) -> Plot:
    return Plot(
        x=Quantity("time_s", "Time", "s"),
        y=Quantity("angle_deg", "Angle", "deg"),
        lines=tuple(
            Line(effort.time_s, effort.angle_deg, f"{effort.age_months:g} months")
            for effort in results
            if effort.behaviour == behaviour
        ),
        title=behaviour.name.capitalize(),
        level=TARGET_DEG,
    )
