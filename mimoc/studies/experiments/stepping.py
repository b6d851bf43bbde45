"""Stepping from birth to three months: what becomes of steps as the body grows, with weights, in water, by practice."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import AGE
from mimoc.bundle.io import Bundle
from mimoc.render.plots.plot import Dots, Line, Plot
from mimoc.studies.experiments.legs.infants import Setup, bundle_of, leg_kg
from mimoc.studies.experiments.legs.intervals import Values, band_of, change_text, interval, relative_changes
from mimoc.studies.experiments.legs.steps import SHARE, TRIES_PER_MIN, StepCase, stepping
from mimoc.studies.experiments.legs.trials import forget_trials, run_cases, write_measures
from mimoc.studies.experiments.notebook import Notebook, table_rows
from mimoc.studies.experiments.weights import step_cases_of

MONTHS: Sequence[float] = (0, 1, 2, 3)
QUICK_MONTHS: Sequence[float] = (0, 2)
PRACTICE = 1.25  # Factor on the strength of practised legs; a guess: no figure is published.
LOADS_KG: Sequence[float] = (0.0, 0.1, 0.2, 0.4, 0.8)
QUICK_LOADS_KG: Sequence[float] = (0.0, 0.4)
LOADED_MONTHS = 1.0
SEEDS, QUICK_SEEDS = range(20), range(2)
SECONDS, QUICK_SECONDS = 30.0, 15.0
RATE = Quantity("rate_per_min", "Steps", "1/min")
LIFT = Quantity("lift_cm", "Lift of the foot", "cm")
HIP = Quantity("hip_deg", "Range of the hip", "deg")
MEASURES = (RATE, LIFT, HIP)
PUBLISHED_RATE = (5.0, 20.0)  # Steps of newborns a minute (an assumption).
GONE_MONTHS = 2.0
LOAD = Quantity("weight_kg", "Weight at each ankle", "kg")

Steps = Mapping[StepCase, Values]


def run(notebook: Notebook) -> Path:
    """Let infants of several ages step, and return the path of the report."""
    quick = notebook.quick
    months, loads_kg = (QUICK_MONTHS, QUICK_LOADS_KG) if quick else (MONTHS, LOADS_KG)
    seeds, seconds = (QUICK_SEEDS, QUICK_SECONDS) if quick else (SEEDS, SECONDS)
    by_age = {age: cases_of(age, seconds) for age in months}
    loaded = [StepCase(LOADED_MONTHS, seconds, weight_kg=load_kg) for load_kg in loads_kg]
    cases = [case for cases in by_age.values() for case in cases.values()] + loaded
    results = run_cases(notebook, [(stepping, case) for case in cases], seeds)
    names = ("age_months", "weight_kg", "water", "strength", "reflex")
    write_measures(notebook, "steps.csv", results, seeds, **{name: name for name in names})
    steps: Steps = {case: [result.values for result in same] for case, same in results.items()}
    means = [interval(_of(steps[case], RATE)) for case in loaded]
    rates, band = [mean.mean for mean in means], band_of(loads_kg, means, "", "band")
    line, dots = Line(loads_kg, rates, "", "median"), Dots(loads_kg, rates, "", "median")
    load_plot = Plot(LOAD, RATE, (line,), (band,), (dots,), title=f"Steps by load at {LOADED_MONTHS:g} month")
    notebook.write_plots("stepping.png", [*_age_plots(steps, by_age), load_plot])
    page = notebook.write_page(
        None,
        "scipy",
        months=", ".join(f"{age:g}" for age in months),
        seeds=len(seeds),
        seconds=seconds,
        share=SHARE,
        tries=TRIES_PER_MIN,
        practice=PRACTICE,
        table=table_rows(
            (
                f"{age:g}",
                f"{1000 * leg_kg(age):.0f}",
                *(interval(_of(steps[cases["plain"]], measure)).text(1) for measure in MEASURES),
                *(interval(_of(steps[cases["reflex"]], measure)).text(1) for measure in (RATE, LIFT)),
            )
            for age, cases in by_age.items()
        ),
        changes=table_rows(
            (
                f"{age:g}",
                measure.label,
                *(
                    change_text(relative_changes(steps[cases["plain"]], steps[cases[name]], measure.name))
                    for name in ("weights", "water", "practised")
                ),
            )
            for age, cases in by_age.items()
            for measure in (RATE, LIFT)
        ),
        answer=_answer(steps, by_age),
        loaded=LOADED_MONTHS,
    )
    forget_trials(notebook)
    return page


def infants(law: None) -> Iterator[Bundle]:
    """Yield the infant at each age, held upright."""
    yield from (bundle_of(Setup(age_months, held=True)) for age_months in MONTHS)


def cases_of(age_months: float, seconds: float) -> dict[str, StepCase]:
    """Return the cases of an age: plain, weights, water, legs that are stronger by practice, and the reflex instead."""
    cases = step_cases_of(age_months, seconds)
    plain = cases["plain"]
    return {**cases, "practised": replace(plain, strength=PRACTICE), "reflex": replace(plain, reflex=True)}


def _of(values: Values, measure: Quantity) -> list[float]:
    return [measures[measure.name] for measures in values]


def _answer(steps: Steps, by_age: Mapping[float, Mapping[str, StepCase]]) -> str:
    rates = {age: interval(_of(steps[cases["plain"]], RATE)) for age, cases in by_age.items()}
    newborn, later = rates[0], rates[GONE_MONTHS]
    low, high = PUBLISHED_RATE
    inside = "inside" if newborn.overlaps(low, high) else "**outside**"
    gone = "gone" if later.mean < 0.2 * newborn.mean else "**not gone**"
    published = f"{inside} the {low:g} to {high:g} that are assumed of real ones, and to which the drive was fitted"
    return (
        f"Newborns take {newborn.text(1)} steps a minute, {published}. At {GONE_MONTHS:g} months, with the same drive, "
        f"it is {later.text(1)}: steps are {gone}."
    )


def _age_plots(steps: Steps, by_age: Mapping[float, Mapping[str, StepCase]]) -> Iterator[Plot]:
    for measure in (RATE, LIFT):
        lines, bands = [], []
        for name in next(iter(by_age.values())):
            means = [interval(_of(steps[cases[name]], measure)) for cases in by_age.values()]
            lines.append(Line(list(by_age), [mean.mean for mean in means], name))
            bands.append(band_of(list(by_age), means, name))
        yield Plot(AGE, measure, tuple(lines), tuple(bands), title=measure.label)
