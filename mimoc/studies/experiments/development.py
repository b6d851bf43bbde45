"""Motor development from birth to two years: milestones, strength, posture at rest, and how much they hang on."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import AGE
from mimoc.compiler.looks.pictures import encode_palette_png
from mimoc.render.picture_files import tile_pictures
from mimoc.render.plots.file import encode
from mimoc.render.plots.plot import Line, Plot
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiments.notebook import Notebook, markdown_table, table_rows
from mimoc.studies.experiments.resting import FALLING_S, LEANS, LYING_S, Rest, rest, try_to_sit
from mimoc.studies.experiments.strength import GROUPS, Strength, strengths
from mimoc.studies.growth.plot import AgeRow, rows_sheet
from mimoc.studies.milestones import MILESTONES, TRIALS, WINDOWS, Conditions
from mimoc.studies.milestones.search import Case, SearchResult, forget_searches, run_searches

LAWS: tuple[Development, ...] = ("maturing", "published")
VARIATIONS: Mapping[str, Conditions] = {  # What the ages of milestones may hang on; pushes in body weights.
    "servo x 0.8": Conditions(servo=0.8),
    "servo x 1.25": Conditions(servo=1.25),
    "strength - 15 %": Conditions(strength=0.85),
    "strength + 15 %": Conditions(strength=1.15),
    "pushes of 0.01": Conditions(push=0.01),
    "pushes of 0.05": Conditions(push=0.05),
}

AGES: Sequence[float] = (*(half / 2 for half in range(29)), 18, 24)
"""Ages at which milestones are tried: every half month to 14 months, when all of them are reached."""
PUBLISHED_AGES: Sequence[float] = (0, 1, 2, 3, 4, 6, 9, 12, 15, 18, 24)
"""Those of the published law, by which most is possible from birth."""
QUICK_AGES: Sequence[float] = (0, 6, 18)
NAMES, QUICK_NAMES = tuple(TRIALS), ("prone_head", "no_head_lag")
VARIED_NAMES = tuple(trial.name for trial in MILESTONES)
MONTHS: Sequence[float] = (0, 1, 2, 3, 4, 6, 9, 12, 15, 18, 24)
QUICK_MONTHS: Sequence[float] = (0, 6, 18)
COMPARED_MONTHS = 18  # Age of the reference body, whose strength is 1; one of `MONTHS` and of `QUICK_MONTHS`.
SITTING_MONTHS, QUICK_SITTING_MONTHS = (0, 3, 6, 9, 12, 18, 24), (0, 18)
OLDEST_SHOWN_MONTHS = 18.0
COLOURS = 128  # Number of colours of the pictures of infants.

Motors = Mapping[tuple[str, str, int], Sequence[Strength]]  # Strength by age, by law, actuator and direction.
Reached = Mapping[str, Mapping[str, float | None]]  # Youngest age, if it is reached, by trial and law or condition.


def run(notebook: Notebook) -> Path:
    """Let infants of many ages try what real infants learn to do, and return the path of the report."""
    quick = notebook.quick
    months, sitting = (QUICK_MONTHS, QUICK_SITTING_MONTHS) if quick else (MONTHS, SITTING_MONTHS)
    names = QUICK_NAMES if quick else NAMES
    ages = {"maturing": AGES, "published": PUBLISHED_AGES}
    cases = {
        (law, name): Case(law, name, tuple(QUICK_AGES if quick else ages[law]), Conditions())
        for law in LAWS
        for name in names
    }
    varied = [name for name in names if name in VARIED_NAMES]
    count = notebook.counter(len(LAWS) * (2 * len(months) + len(sitting)) + len(cases) + len(VARIATIONS) * len(varied))
    strong = [item for law in LAWS for age in months for item in count(list(strengths(law, age)))]
    motors = _write_strengths(notebook, strong)
    rests = [count(rest(law, age)) for law in LAWS for age in months]
    slumps = ",".join(f"slump_from_{lean:g}_deg" for lean in LEANS)
    heading = f"development,age_months,hip_deg,knee_deg,elbow_deg,head_upright_deg,head_leaning_back_deg,{slumps}"
    notebook.write_table("rest.csv", heading, map(_rest_cells, rests))
    sitters = tile_pictures([[count(try_to_sit(law, age)) for age in sitting] for law in LAWS], rows=LAWS)
    notebook.write_picture("sitting.png", encode_palette_png(sitters, COLOURS))

    def searched(cases: Sequence[Case]) -> Mapping[Case, SearchResult]:
        return run_searches(cases, notebook.folder, 1 if quick else os.cpu_count() or 1, lambda: count(None))

    results = searched(list(cases.values()))
    reached = {name: {law: results[cases[law, name]].youngest_months for law in LAWS} for name in names}
    _write_milestones(notebook, results, reached)
    sensitivity = _vary({name: cases["maturing", name] for name in varied}, reached, searched)
    rows = ((name, *item) for name, by_condition in sensitivity.items() for item in by_condition.items())
    notebook.write_table("sensitivity.csv", "milestone,condition,age_months", rows)
    notebook.write_picture("sensitivity.png", _rows_png([AgeRow(name, ages) for name, ages in sensitivity.items()]))
    page = notebook.write_page(
        None,
        milestones=_milestones(reached),
        rising=_steady(motors, "maturing", 1),
        falling=_steady(motors, "published", -1),
        strengths=_strengths(motors),
        **_rests(rests),
        sensitivity=_sensitivity(reached, sensitivity),
    )
    forget_searches(notebook.folder)
    return page


def infants(law: None) -> Iterator[InfantSpec]:
    """Yield the average child by both laws at some of the ages."""
    for development in LAWS:
        for age_months in QUICK_MONTHS:
            yield InfantSpec(mimoc=1, name="average_child", age_months=age_months, development=development)


def _vary(
    cases: Mapping[str, Case], reached: Reached, searched: Callable[[Sequence[Case]], Mapping[Case, SearchResult]]
) -> Reached:
    """Return the ages of milestones under other conditions, searched for from the usual ages of `maturing` on."""
    others = {
        name: {label: replace(case, conditions=other, near_months=months) for label, other in VARIATIONS.items()}
        for name, case in cases.items()
        if (months := reached[name]["maturing"]) is not None
    }
    results = searched([case for varied in others.values() for case in varied.values()])
    return {
        name: {label: results[case].youngest_months for label, case in varied.items()}
        for name, varied in others.items()
    }


def _write_strengths(notebook: Notebook, measured: Sequence[Strength]) -> Motors:
    heading = "development,age_months,actuator,direction,torque_nm,moment_nm,ratio"
    directions = {1: "positive", -1: "negative"}
    cells = (
        (it.development, it.age_months, it.actuator, directions[it.direction], it.torque_nm, it.moment_nm, it.ratio)
        for it in measured
    )
    notebook.write_table("strength.csv", heading, cells)
    motors: dict[tuple[str, str, int], list[Strength]] = {}
    for item in measured:
        motors.setdefault((item.development, item.actuator, item.direction), []).append(item)
    notebook.write_plots("strength.png", [_strength_plot(motors, law) for law in LAWS])
    return motors


def _strength_plot(motors: Motors, law: str) -> Plot:
    lines = []
    for group, motor in GROUPS.items():
        ratios = {item.age_months: item.ratio for item in motors[law, *motor]}
        relative = [ratio / ratios[COMPARED_MONTHS] for ratio in ratios.values()]
        lines.append(Line(list(ratios), relative, group, "marked"))
    y = Quantity("ratio", "Torque / gravity moment, relative to 18 months")
    return Plot(AGE, y, tuple(lines), title=law, level=1.0)


def _steady(motors: Motors, law: str, sign: int) -> str:
    """Return for how many motors and directions the ratio only rises, or only falls, from birth to 18 months."""
    by_motor = [
        [sign * item.ratio for item in items if item.age_months <= COMPARED_MONTHS]
        for (development, *_), items in motors.items()
        if development == law
    ]
    steady = sum(ratios == sorted(set(ratios)) for ratios in by_motor)
    return f"all {len(by_motor)}" if steady == len(by_motor) else f"{steady} of {len(by_motor)}"


def _strengths(motors: Motors) -> str:
    ages = [f"{item.age_months:g} months" for item in next(iter(motors.values()))]
    rows = [
        (law, group, f"`{motor[0]}`", *(f"{item.ratio:.2f}" for item in motors[law, *motor]))
        for law in LAWS
        for group, motor in GROUPS.items()
    ]
    return markdown_table(("law", "group", "motor", *ages), rows)


def _rest_cells(rested: Rest) -> tuple[Any, ...]:
    *numbers, slumps_deg = astuple(rested)
    return *numbers, *slumps_deg


def _rests(rests: Sequence[Rest]) -> dict[str, object]:
    headings = ("law", "months", "hip", "knee", "elbow", "head, upright", "head, leaning back")
    rows = (
        (law, f"{age_months:g}", *(f"{angle:.0f}" for angle in angles))
        for law, age_months, *angles in map(_rest_cells, rests)
    )
    return {
        "lying_s": LYING_S,
        "falling_s": FALLING_S,
        "rests": markdown_table((*headings, *(f"sits from {lean:g}" for lean in LEANS)), rows),
        **{rested.development: rested for rested in rests if rested.age_months == 0},
        **{f"{law}_forward": _forward([rested for rested in rests if rested.development == law]) for law in LAWS},
    }


def _forward(rests: Sequence[Rest]) -> str:
    parts = []
    for index, lean in enumerate(LEANS):
        ages = [f"{rested.age_months:g}" for rested in rests if rested.slumps_deg[index] > 0]
        some = f"{', '.join(ages)} months" if ages else "no age"
        parts.append(f"from {lean:g} at {'all ages' if len(ages) == len(rests) else some}")
    return ", ".join(parts)


def _write_milestones(notebook: Notebook, results: Mapping[Case, SearchResult], reached: Reached) -> None:
    heading = "development,milestone,age_months,success,ended_s,reason,posture"
    attempts = (
        (case.development, case.trial, age, "yes" if it.success else "no", it.seconds, it.reason, it.strategy)
        for case, result in results.items()
        for age, it in result.outcomes.items()
    )
    notebook.write_table("attempts.csv", heading, attempts)
    windows = {name: (window.youngest_months, window.oldest_months) for name, window in WINDOWS.items()}
    rows = [AgeRow(name, by_law, windows.get(name, ())) for name, by_law in reached.items()]
    notebook.write_picture("milestones.png", _rows_png(rows))


def _rows_png(rows: Sequence[AgeRow]) -> bytes:
    return encode(rows_sheet(rows, "real infants", ages_months=(0.0, OLDEST_SHOWN_MONTHS)))


def _milestones(reached: Reached) -> str:
    rows = []
    for name, by_law in reached.items():
        window = WINDOWS.get(name)
        real = f"{window.youngest_months:g} to {window.oldest_months:g} ({window.span})" if window else "not known"
        rows.append((TRIALS[name].title, *map(_months, by_law.values()), real, window.source if window else ""))
    return table_rows(rows)


def _months(age_months: float | None) -> str:
    return "not reached" if age_months is None else f"{age_months:g}"


def _sensitivity(reached: Reached, sensitivity: Reached) -> str:
    rows = [
        (TRIALS[name].title, *map(_months, (reached[name]["maturing"], *by_condition.values())))
        for name, by_condition in sensitivity.items()
    ]
    return markdown_table(("trial", "as above", *VARIATIONS), rows)
