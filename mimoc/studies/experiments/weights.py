"""Weights on legs: a hundred grams on one leg that kicks, and the gain of four weeks, or water, on legs that step."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.motion.points import SIDES
from mimoc.movement.filming import RATE_HZ
from mimoc.movement.joints import joint_angles
from mimoc.movement.measures import kicks_of, leg_lengths
from mimoc.movement.trunk_frame import trunk_paths
from mimoc.render.plots.plot import Dots, Line, Plot
from mimoc.studies.experiments.legs.driving import LIMBS, Mover
from mimoc.studies.experiments.legs.infants import MONTHS_PER_WEEK, Setup, bundle_of, leg_kg, open_infant
from mimoc.studies.experiments.legs.intervals import Values, band_of, change_text, direction, interval, relative_changes
from mimoc.studies.experiments.legs.steps import StepCase, stepping
from mimoc.studies.experiments.legs.trials import Result, forget_trials, run_cases, write_measures
from mimoc.studies.experiments.notebook import Notebook, table_rows

WEEKS: Sequence[float] = (6, 12, 18, 26)
QUICK_WEEKS: Sequence[float] = (6,)
WEIGHT_KG = 0.1
GAINS: Sequence[float] = (1.0, 1.25, 1.5)
"""Factors on the drive of both legs that are tried with the weight on, at the ages at which both legs changed."""
CHANGED_WEEKS = 12
STEP_WEEKS: Sequence[float] = (4, 8)
QUICK_STEP_WEEKS: Sequence[float] = (4,)
GAIN_WEEKS = 4
SEEDS, QUICK_SEEDS = range(20), range(2)
SECONDS, QUICK_SECONDS = 40.0, 15.0
STEP_SECONDS = 30.0
LEAST = 0.1  # Least change of the range of the hip that mass alone is asked for at six weeks.
STEP_LEAST = 0.2  # Least change of steps that is asked for each way.
PUBLISHED: Mapping[float, tuple[str, str]] = {
    6: ("less", "more"),
    12: ("more", "more"),
    18: ("same", "same"),
    26: ("same", "same"),
}
"""What Vaal, van Soest & Hopkins 2000 report of the leg with the weight and the other, by weeks."""
KICKS = Quantity("rate_per_min", "Kicks", "1/min")
MEASURES = (
    KICKS,
    Quantity("hip_deg", "Range of the hip", "deg"),
    Quantity("speed_trunk_s", "Mean speed of the foot", "trunk/s"),
)
STEP_MEASURES = (Quantity("rate_per_min", "Steps", "1/min"), Quantity("lift_cm", "Lift of the foot", "cm"))
WEEK = Quantity("weeks", "Age", "weeks")


@dataclass(frozen=True, slots=True)
class Case:
    """Infants that kick for a while, perhaps with a weight at the left ankle."""

    weeks: float
    seconds: float
    weight_kg: float = 0.0
    gain: float = 1.0  # Factor on the drive of both legs.


Kicks = Mapping[Case, Values]
Steps = Mapping[StepCase, Values]


def run(notebook: Notebook) -> Path:
    """Let infants kick and step with weights, and return the path of the report."""
    quick = notebook.quick
    weeks, step_weeks = (QUICK_WEEKS, QUICK_STEP_WEEKS) if quick else (WEEKS, STEP_WEEKS)
    seeds, seconds = (QUICK_SEEDS, QUICK_SECONDS) if quick else (SEEDS, SECONDS)
    step_seconds = QUICK_SECONDS if quick else STEP_SECONDS
    cases = list[Case]()
    for week in weeks:
        plain = Case(week, seconds)
        cases += [plain, *(replace(plain, weight_kg=WEIGHT_KG, gain=gain) for gain in _gains_at(week))]
    step_cases = [case for week in step_weeks for case in step_cases_of(week * MONTHS_PER_WEEK, step_seconds).values()]
    tried: list[tuple[Callable[[Any, int], Result], Any]] = [(kicking, case) for case in cases]
    results = run_cases(notebook, [*tried, *((stepping, case) for case in step_cases)], seeds)
    kicked, stepped = ({case: results[case] for case in some} for some in (cases, step_cases))
    write_measures(notebook, "weights.csv", kicked, seeds, weeks="weeks", weight_kg="weight_kg", drive="gain")
    names = ("age_months", "weight_kg", "water")
    write_measures(notebook, "steps.csv", stepped, seeds, **{name: name for name in names})
    kicks: Kicks = {case: [result.values for result in results[case]] for case in cases}
    steps: Steps = {case: [result.values for result in results[case]] for case in step_cases}
    notebook.write_plots("weights.png", list(_plots(kicks)))
    page = notebook.write_page(
        None,
        "scipy",
        seeds=len(seeds),
        seconds=seconds,
        weight=1000 * WEIGHT_KG,
        weeks=", ".join(f"{week:g}" for week in weeks),
        table=_table(kicks, weeks, seconds),
        gains=_gains(kicks, weeks, seconds),
        answer=_answer(kicks, weeks, seconds),
        step_seconds=step_seconds,
        steps=_step_table(steps, step_weeks, step_seconds),
        gain_weeks=GAIN_WEEKS,
    )
    forget_trials(notebook)
    return page


def infants(law: None) -> Iterator[Bundle]:
    """Yield the infants of all ages that kick, and those that step."""
    yield from (bundle_of(Setup(week * MONTHS_PER_WEEK)) for week in WEEKS)
    yield from (bundle_of(Setup(week * MONTHS_PER_WEEK, held=True)) for week in STEP_WEEKS)


def step_cases_of(age_months: float, seconds: float) -> dict[str, StepCase]:
    """Return how an infant of an age steps: plain, with what a leg gains in four weeks at each ankle, and in water."""
    gain_kg = leg_kg(age_months + GAIN_WEEKS * MONTHS_PER_WEEK) - leg_kg(age_months)
    plain = StepCase(age_months, seconds)
    return {"plain": plain, "weights": replace(plain, weight_kg=round(gain_kg, 3)), "water": replace(plain, water=True)}


def kicking(case: Case, seed: int) -> Result:
    """Let an infant lie on its back and move by itself for a while, and measure how much each leg moves."""
    setup = Setup(case.weeks * MONTHS_PER_WEEK, left_kg=case.weight_kg)
    with closing(open_infant(setup)) as env:
        mover = Mover(env, seed)
        mover.set_gains(np.array([1.0 if limb.endswith("arm") else case.gain for limb in LIMBS]))
        film = mover.film(case.seconds)
    body, angles_deg, values = trunk_paths(film.seen), joint_angles(film.space or film.seen), {}
    for side, length in zip(SIDES, leg_lengths(body), strict=True):
        low, high = np.percentile(angles_deg[f"{side}_hip"], [5.0, 95.0])
        values |= {
            f"{side}_rate_per_min": len(kicks_of(length, RATE_HZ)) / body.minutes,
            f"{side}_hip_deg": float(high - low),
            f"{side}_speed_trunk_s": float(body.speeds[f"{side}_foot"].mean()),
        }
    return Result(values=values)


def _gains_at(week: float) -> Sequence[float]:
    return GAINS if week <= CHANGED_WEEKS else GAINS[:1]


def _changes(kicks: Kicks, week: float, seconds: float, gain: float, side: str, measure: str) -> list[float]:
    plain = Case(week, seconds)
    return relative_changes(kicks[plain], kicks[replace(plain, weight_kg=WEIGHT_KG, gain=gain)], f"{side}_{measure}")


def _table(kicks: Kicks, weeks: Sequence[float], seconds: float) -> str:
    rows = []
    for week in weeks:
        for measure in MEASURES:
            changes = [_changes(kicks, week, seconds, 1.0, side, measure.name) for side in SIDES]
            plain = interval([values[f"left_{measure.name}"] for values in kicks[Case(week, seconds)]])
            rows.append((f"{week:g}", measure.heading, plain.text(), *map(change_text, changes), *PUBLISHED[week]))
    return table_rows(rows)


def _gains(kicks: Kicks, weeks: Sequence[float], seconds: float) -> str:
    rows = []
    for week in weeks:
        for gain in _gains_at(week):
            ours = [direction(_changes(kicks, week, seconds, gain, side, "speed_trunk_s")) for side in SIDES]
            changes = [change_text(_changes(kicks, week, seconds, gain, side, "speed_trunk_s")) for side in SIDES]
            agrees = "unclear" if "unclear" in ours else "yes" if tuple(ours) == PUBLISHED[week] else "no"
            rows.append((f"{week:g}", f"{gain:g}", *changes, ", ".join(ours), agrees))
    return table_rows(rows)


def _answer(kicks: Kicks, weeks: Sequence[float], seconds: float) -> str:
    change = interval(_changes(kicks, weeks[0], seconds, 1.0, "left", "hip_deg"))
    holds = "does" if change.mean <= -LEAST else "does **not**"
    return (
        f"At {weeks[0]:g} weeks, the weight alone changes the range of the hip of its leg by "
        f"{change.text(percent=True)}: it {holds} lower it by the {LEAST:.0%} that were asked for."
    )


def _step_table(steps: Steps, weeks: Sequence[float], seconds: float) -> str:
    rows = []
    for week in weeks:
        cases = step_cases_of(week * MONTHS_PER_WEEK, seconds)
        for measure in STEP_MEASURES:
            plain = steps[cases["plain"]]
            changes = {name: relative_changes(plain, steps[cases[name]], measure.name) for name in ("weights", "water")}
            falls, rises = (direction(changes[name], STEP_LEAST) for name in ("weights", "water"))
            verdict = f"{_verdict(falls, 'less')}, {_verdict(rises, 'more')}"
            mean = interval([values[measure.name] for values in plain]).text(1)
            weight_g = f"{1000 * cases['weights'].weight_kg:.0f} g"
            rows.append((f"{week:g}", measure.heading, mean, weight_g, *map(change_text, changes.values()), verdict))
    return table_rows(rows)


def _verdict(shown: str, asked: str) -> str:
    return "unclear" if shown == "unclear" else "yes" if shown == asked else "no"


def _plots(kicks: Kicks) -> Iterator[Plot]:
    weeks = sorted({case.weeks for case in kicks})
    seconds = next(iter(kicks)).seconds
    for measure in MEASURES:
        lines, bands, dots = [], [], []
        for side, label in zip(SIDES, ("leg with the weight", "other leg"), strict=True):
            changes = [_changes(kicks, week, seconds, 1.0, side, measure.name) for week in weeks]
            means = [interval([100 * change for change in part]) for part in changes if part]
            known = [week for week, part in zip(weeks, changes, strict=True) if part]
            lines.append(Line(known, [mean.mean for mean in means], label))
            bands.append(band_of(known, means, label))
            dots.append(Dots(known, [mean.mean for mean in means], label))
        change = Quantity("change", f"{measure.label}: change by the weight", "%")
        yield Plot(WEEK, change, tuple(lines), tuple(bands), tuple(dots), title=measure.label, level=0.0)
