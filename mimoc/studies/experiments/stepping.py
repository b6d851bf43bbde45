"""Stepping from birth to three months: what becomes of steps as the body grows, with weights, in water, by practice."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import AGE
from mimoc.render.plots.plot import Dots, Line, Plot
from mimoc.studies.comparison import band_of, change_text, relative_changes
from mimoc.studies.experiment import Experiment, Results, measures_table
from mimoc.studies.experiments.legs import Setup, bundle_of, leg_kg
from mimoc.studies.experiments.steps import SHARE, TRIES_PER_MIN, StepCase, stepping
from mimoc.studies.experiments.weights import step_cases_of
from mimoc.studies.notebook import PAGES, Notebook, table_rows

MONTHS: Sequence[float] = (0, 1, 2, 3)
QUICK_MONTHS: Sequence[float] = (0, 2)
PRACTICE = 1.25  # Factor on the strength of practised legs; a guess: no figure is published.
LOADS_KG: Sequence[float] = (0.0, 0.1, 0.2, 0.4, 0.8)
QUICK_LOADS_KG: Sequence[float] = (0.0, 0.4)
LOADED_MONTHS = 1.0
SECONDS, QUICK_SECONDS = 30.0, 15.0
RATE = Quantity("rate_per_min", "Steps", "1/min")
LIFT = Quantity("lift_cm", "Lift of the foot", "cm")
HIP = Quantity("hip_deg", "Range of the hip", "deg")
MEASURES = (RATE, LIFT, HIP)
PUBLISHED_RATE = (5.0, 20.0)  # Steps of newborns a minute (an assumption).
GONE_MONTHS = 2.0
LOAD = Quantity("weight_kg", "Weight at each ankle", "kg")


def cases(notebook: Notebook) -> list[StepCase]:
    """Return the cases of all ages, and those with several loads at one age."""
    months, loads_kg = (QUICK_MONTHS, QUICK_LOADS_KG) if notebook.quick else (MONTHS, LOADS_KG)
    seconds = QUICK_SECONDS if notebook.quick else SECONDS
    loaded = [StepCase(LOADED_MONTHS, seconds, weight_kg=load_kg) for load_kg in loads_kg]
    return [case for age in months for case in cases_of(age, seconds).values()] + loaded


def cases_of(age_months: float, seconds: float) -> dict[str, StepCase]:
    """Return the cases of an age: plain, weights, water, legs that are stronger by practice, and the reflex instead."""
    cases = step_cases_of(age_months, seconds)
    plain = cases["plain"]
    return {**cases, "practised": replace(plain, strength=PRACTICE), "reflex": replace(plain, reflex=True)}


def _by_age(results: Results) -> dict[float, dict[str, StepCase]]:
    months = QUICK_MONTHS if results.notebook.quick else MONTHS
    return {age: cases_of(age, next(iter(results.by_case)).seconds) for age in months}


def _plots(results: Results) -> Iterator[Plot]:
    by_age = _by_age(results)
    for measure in (RATE, LIFT):
        lines, bands = [], []
        for name in next(iter(by_age.values())):
            means = [results.mean(cases[name], measure.name) for cases in by_age.values()]
            lines.append(Line(list(by_age), [mean.mean for mean in means], name))
            bands.append(band_of(list(by_age), means, name))
        yield Plot(AGE, measure, tuple(lines), tuple(bands), title=measure.label)
    loads_kg, seconds = QUICK_LOADS_KG if results.notebook.quick else LOADS_KG, next(iter(results.by_case)).seconds
    means = [results.mean(StepCase(LOADED_MONTHS, seconds, weight_kg=load), RATE.name) for load in loads_kg]
    rates, band = [mean.mean for mean in means], band_of(loads_kg, means, "", "band")
    line, dots = Line(loads_kg, rates, "", "median"), Dots(loads_kg, rates, "", "median")
    yield Plot(LOAD, RATE, (line,), (band,), (dots,), title=f"Steps by load at {LOADED_MONTHS:g} month")


def _numbers(results: Results) -> dict[str, object]:
    by_age = _by_age(results)

    def mean(case: StepCase, measure: Quantity) -> str:
        return results.mean(case, measure.name).text(1)

    def change(cases: Mapping[str, StepCase], name: str, measure: Quantity) -> str:
        plain, changed = ([it.values for it in results.by_case[cases[which]]] for which in ("plain", name))
        return change_text(relative_changes(plain, changed, measure.name))

    return {
        "months": ", ".join(f"{age:g}" for age in by_age),
        "seconds": next(iter(results.by_case)).seconds,
        "share": SHARE,
        "tries": TRIES_PER_MIN,
        "practice": PRACTICE,
        "table": table_rows(
            (
                f"{age:g}",
                f"{1000 * leg_kg(age):.0f}",
                *(mean(cases["plain"], measure) for measure in MEASURES),
                *(mean(cases["reflex"], measure) for measure in (RATE, LIFT)),
            )
            for age, cases in by_age.items()
        ),
        "changes": table_rows(
            (f"{age:g}", measure.label, *(change(cases, name, measure) for name in ("weights", "water", "practised")))
            for age, cases in by_age.items()
            for measure in (RATE, LIFT)
        ),
        "answer": _answer(results, by_age),
        "loaded": LOADED_MONTHS,
    }


def _answer(results: Results, by_age: Mapping[float, Mapping[str, StepCase]]) -> str:
    newborn, later = (results.mean(by_age[age]["plain"], RATE.name) for age in (0, GONE_MONTHS))
    low, high = PUBLISHED_RATE
    inside = "inside" if low <= newborn.mean <= high else "**outside**"
    gone = "gone" if later.mean < 0.2 * newborn.mean else "**not gone**"
    published = f"{inside} the {low:g} to {high:g} that are assumed of real ones, and to which the drive was fitted"
    return (
        f"Newborns take {newborn.text(1)} steps a minute, {published}. At {GONE_MONTHS:g} months, with the same drive, "
        f"it is {later.text(1)}: steps are {gone}."
    )


EXPERIMENT = Experiment(
    name="stepping",
    trial=stepping,
    cases=cases,
    seeds=range(20),
    quick={"seeds": range(2)},
    files={
        "steps.csv": measures_table(
            age_months="age_months", weight_kg="weight_kg", water="water", strength="strength", reflex="reflex"
        ),
        "stepping.png": _plots,
    },
    page=PAGES / "stepping.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: (bundle_of(Setup(age_months, held=True)) for age_months in MONTHS),
)
