"""Weights on legs: a hundred grams on one leg that kicks, and the gain of four weeks, or water, on legs that step."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.motion.labels import SIDES
from mimoc.movement.filming import RATE_HZ
from mimoc.movement.measured import joint_angles
from mimoc.movement.measures import kicks_of, leg_lengths, trunk_paths
from mimoc.render.plots import Dots, Line, Plot
from mimoc.studies.comparison import band_of, change_text, direction, interval, relative_changes
from mimoc.studies.experiment import Experiment, Results, TrialResult, measures_table
from mimoc.studies.experiments.legs import LIMBS, MONTHS_PER_WEEK, Mover, Setup, bundle_of, open_infant
from mimoc.studies.experiments.stepping import GAIN_WEEKS, StepCase, step_cases_of, stepping
from mimoc.studies.notebook import PAGES, Notebook, table_rows

WEEKS: Sequence[float] = (6, 12, 18, 26)
QUICK_WEEKS: Sequence[float] = (6,)
WEIGHT_KG = 0.1
GAINS: Sequence[float] = (1.0, 1.25, 1.5)
"""Factors on the drive of both legs that are tried with the weight on, at the ages at which both legs changed."""
CHANGED_WEEKS = 12
STEP_WEEKS: Sequence[float] = (4, 8)
QUICK_STEP_WEEKS: Sequence[float] = (4,)
SECONDS, QUICK_SECONDS = 40.0, 15.0
STEP_SECONDS = 30.0
MIN_HIP_CHANGE = 0.1  # Mass alone is asked to lower the range of the hip by this share at six weeks.
MIN_STEP_CHANGE = 0.2  # A measure of steps is asked to change by at least this share.
EXPECTED_STEPS: Mapping[str, str] = {"weights": "less", "water": "more"}
"""Whether there is to be more or less stepping than without, by case of `step_cases_of`."""
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


def cases(notebook: Notebook) -> list[Case | StepCase]:
    """Return infants that kick without and with the weight, then those that step."""
    weeks, step_weeks = (QUICK_WEEKS, QUICK_STEP_WEEKS) if notebook.quick else (WEEKS, STEP_WEEKS)
    seconds, step_seconds = (QUICK_SECONDS, QUICK_SECONDS) if notebook.quick else (SECONDS, STEP_SECONDS)
    tried = list[Case | StepCase]()
    for week in weeks:
        plain = Case(week, seconds)
        tried += [plain, *(replace(plain, weight_kg=WEIGHT_KG, gain=gain) for gain in _gains_at(week))]
    for week in step_weeks:
        tried += step_cases_of(week * MONTHS_PER_WEEK, step_seconds).values()
    return tried


def move(case: Case | StepCase, seed: int) -> TrialResult:
    """Let an infant step, or lie on its back and move by itself, for a while, and measure how much each leg moves."""
    if isinstance(case, StepCase):
        return stepping(case, seed)
    setup = Setup(case.weeks * MONTHS_PER_WEEK, left_kg=case.weight_kg)
    with closing(open_infant(setup)) as env:
        mover = Mover(env, seed)
        mover.set_gains(np.array([1.0 if limb.endswith("arm") else case.gain for limb in LIMBS]))
        film = mover.film(case.seconds)
    body = trunk_paths(film.seen)
    angles_deg = joint_angles(film.space or film.seen)
    values = dict[str, float]()
    for side, length in zip(SIDES, leg_lengths(body), strict=True):
        low, high = np.percentile(angles_deg[f"{side}_hip"], [5.0, 95.0])
        values |= {
            f"{side}_rate_per_min": len(kicks_of(length, RATE_HZ)) / body.minutes,
            f"{side}_hip_deg": float(high - low),
            f"{side}_speed_trunk_s": float(body.speeds[f"{side}_foot"].mean()),
        }
    return TrialResult(values=values)


def _gains_at(week: float) -> Sequence[float]:
    return GAINS if week <= CHANGED_WEEKS else GAINS[:1]


def _plain_kicks(results: Results) -> list[Case]:
    """Return the cases without a weight, by age."""
    return [case for case in results.by_case if isinstance(case, Case) and not case.weight_kg]


def _compared(results: Results, plain: Case | StepCase, changed: Case | StepCase, measure: str) -> list[float]:
    before, after = ([result.values for result in results.by_case[case]] for case in (plain, changed))
    return relative_changes(before, after, measure)


def _changes(results: Results, plain: Case, gain: float, side: str, measure: str) -> list[float]:
    """Return the relative change of a leg's measure by the weight, and a gain of the drive, of each seed."""
    return _compared(results, plain, replace(plain, weight_kg=WEIGHT_KG, gain=gain), f"{side}_{measure}")


def _plots(results: Results) -> Iterator[Plot]:
    for measure in MEASURES:
        lines, bands, dots = [], [], []
        for side, label in zip(SIDES, ("leg with the weight", "other leg"), strict=True):
            changes = {case.weeks: _changes(results, case, 1.0, side, measure.name) for case in _plain_kicks(results)}
            intervals = {
                week: interval([100 * change for change in of_seeds]) for week, of_seeds in changes.items() if of_seeds
            }
            weeks = list(intervals)
            means = [percent.mean for percent in intervals.values()]
            lines.append(Line(weeks, means, label))
            bands.append(band_of(weeks, list(intervals.values()), label))
            dots.append(Dots(weeks, means, label))
        quantity = Quantity("change", f"{measure.label}: change by the weight", "%")
        yield Plot(WEEK, quantity, tuple(lines), tuple(bands), tuple(dots), title=measure.label, level=0.0)


def _numbers(results: Results) -> dict[str, object]:
    plain = _plain_kicks(results)
    steps = [case for case in results.by_case if isinstance(case, StepCase)]
    change = interval(_changes(results, plain[0], 1.0, "left", "hip_deg"))
    holds = "does" if change.mean <= -MIN_HIP_CHANGE else "does **not**"
    return {
        "seconds": plain[0].seconds,
        "weight": 1000 * WEIGHT_KG,
        "weeks": ", ".join(f"{case.weeks:g}" for case in plain),
        "table": table_rows(_rows(results, plain)),
        "gains": table_rows(_gain_rows(results, plain)),
        "answer": (
            f"At {plain[0].weeks:g} weeks, the weight alone changes the range of the hip of its leg by "
            f"{change.text(percent=True)}: it {holds} lower it by the {MIN_HIP_CHANGE:.0%} that were asked for."
        ),
        "step_seconds": steps[0].seconds,
        "steps": table_rows(_step_rows(results, steps[0].seconds)),
        "gain_weeks": GAIN_WEEKS,
    }


def _rows(results: Results, plain: Sequence[Case]) -> Iterator[tuple[str, ...]]:
    for case in plain:
        for measure in MEASURES:
            changes = [_changes(results, case, 1.0, side, measure.name) for side in SIDES]
            mean = results.mean(case, f"left_{measure.name}")
            yield f"{case.weeks:g}", measure.heading, mean.text(), *map(change_text, changes), *PUBLISHED[case.weeks]


def _gain_rows(results: Results, plain: Sequence[Case]) -> Iterator[tuple[str, ...]]:
    for case in plain:
        for gain in _gains_at(case.weeks):
            changes = [_changes(results, case, gain, side, "speed_trunk_s") for side in SIDES]
            directions = tuple(direction(of_seeds) for of_seeds in changes)
            agrees = "unclear" if "unclear" in directions else "yes" if directions == PUBLISHED[case.weeks] else "no"
            yield f"{case.weeks:g}", f"{gain:g}", *map(change_text, changes), ", ".join(directions), agrees


def _step_rows(results: Results, seconds: float) -> Iterator[tuple[str, ...]]:
    for week in QUICK_STEP_WEEKS if results.notebook.quick else STEP_WEEKS:
        step_cases = step_cases_of(week * MONTHS_PER_WEEK, seconds)
        plain = step_cases["plain"]
        weight_g = f"{1000 * step_cases['weights'].weight_kg:.0f} g"
        for measure in STEP_MEASURES:
            mean = results.mean(plain, measure.name).text(1)
            changes = {name: _compared(results, plain, step_cases[name], measure.name) for name in EXPECTED_STEPS}
            verdicts = [_verdict(direction(changes[name], MIN_STEP_CHANGE), EXPECTED_STEPS[name]) for name in changes]
            yield f"{week:g}", measure.heading, mean, weight_g, *map(change_text, changes.values()), ", ".join(verdicts)


def _verdict(shown: str, expected: str) -> str:
    return "unclear" if shown == "unclear" else "yes" if shown == expected else "no"


EXPERIMENT = Experiment(
    name="weights",
    trial=move,
    cases=cases,
    seeds=range(20),
    quick={"seeds": range(2)},
    files={
        "weights.csv": measures_table(Case, weeks="weeks", weight_kg="weight_kg", drive="gain"),
        "steps.csv": measures_table(StepCase, age_months="age_months", weight_kg="weight_kg", water="water"),
        "weights.png": _plots,
    },
    page=PAGES / "weights.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: (
        *(bundle_of(Setup(week * MONTHS_PER_WEEK)) for week in WEEKS),
        *(bundle_of(Setup(week * MONTHS_PER_WEEK, held=True)) for week in STEP_WEEKS),
    ),
)
