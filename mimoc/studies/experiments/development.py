"""Motor development from birth to two years: milestones, strength, posture at rest, and how much they hang on."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from pathlib import Path
from typing import TypeVar

from mimoc.looks.pictures import encode_palette_png
from mimoc.quantities import Quantity
from mimoc.quantities.child import AGE
from mimoc.render.picture_files import tile_pictures
from mimoc.render.plots.file import encode
from mimoc.render.plots.growth import AgeRow, rows_sheet
from mimoc.render.plots.plot import Line, Plot
from mimoc.schema.names import Development
from mimoc.studies.experiments.effort import GROUPS, Strength, strengths
from mimoc.studies.experiments.notebook import Cell, Notebook, Progress, markdown_table, page_texts
from mimoc.studies.experiments.resting import FALLING_S, LEANS, LYING_S, Rest, Sitter, caption, rest, try_to_sit
from mimoc.studies.milestones import MILESTONES, TRIALS, WINDOWS, Conditions
from mimoc.studies.milestones.search import Case, SearchResult, forget_searches, run_searches

LAWS: tuple[Development, ...] = ("maturing", "published")
VARIATIONS: Mapping[str, Conditions] = {
    "servo x 0.8": Conditions(servo=0.8),
    "servo x 1.25": Conditions(servo=1.25),
    "strength - 15 %": Conditions(strength=0.85),
    "strength + 15 %": Conditions(strength=1.15),
    "pushes of 0.01": Conditions(push=0.01),
    "pushes of 0.05": Conditions(push=0.05),
}
"""What the ages of milestones may hang on; pushes in body weights."""


@dataclass(frozen=True, slots=True)
class Varied:
    """The age of a milestone under other conditions."""

    trial: str
    condition: str
    """A key of `VARIATIONS`."""
    youngest_months: float | None
    """None if it was not reached."""


@dataclass(frozen=True, slots=True)
class Findings:
    """All that was measured."""

    milestones: Mapping[Case, SearchResult]
    strengths: Sequence[Strength]
    rests: Sequence[Rest]
    sensitivity: Sequence[Varied]


TEXTS = page_texts("development")


def _write_page(notebook: Notebook, findings: Findings) -> Path:
    """Write the report, and return its path."""
    sections = (
        TEXTS["about"],
        TEXTS["milestones"].format(table=_milestones(findings.milestones)),
        TEXTS["strength"].format(verdict=_strength_verdict(findings.strengths), table=_strengths(findings.strengths)),
        TEXTS["rest"].format(
            lying_s=LYING_S, falling_s=FALLING_S, table=_rests(findings.rests), verdict=_rest_verdict(findings.rests)
        ),
        TEXTS["sitting"],
        TEXTS["sensitivity"].format(table=_sensitivity_table(findings)),
        TEXTS["limits"],
    )
    return notebook.write_page("Motor development", sections, seeds="Nothing is random.", libraries=["matplotlib"])


def _milestones(results: Mapping[Case, SearchResult]) -> str:
    rows = []
    for name in dict.fromkeys(case.trial for case in results):
        ages = [_months(_youngest(results, law, name)) for law in LAWS]
        window = WINDOWS.get(name)
        real = f"{window.youngest_months:g} to {window.oldest_months:g} ({window.span})" if window else "not known"
        rows.append((TRIALS[name].title, *ages, real, window.source if window else ""))
    return markdown_table(("trial", *LAWS, "real infants", "source"), rows)


def _youngest(results: Mapping[Case, SearchResult], law: str, trial: str) -> float | None:
    matching = (result for case, result in results.items() if (case.development, case.trial) == (law, trial))
    return next(matching).youngest_months


def _months(age_months: float | None) -> str:
    return "not reached" if age_months is None else f"{age_months:g}"


def _strength_verdict(strengths: Sequence[Strength]) -> str:
    rising, falling = (_steady(strengths, law, sign) for law, sign in zip(LAWS, (1, -1), strict=True))
    return (
        f"From birth to 18 months, by `maturing` it rises from each age to the next for {rising} motors and directions,"
        f" by `published` it falls for {falling}."
    )


def _steady(strengths: Sequence[Strength], law: str, sign: int) -> str:
    """Return for how many motors and directions the ratio only rises, or only falls, from birth to 18 months."""
    by_motor: dict[tuple[str, int], list[float]] = {}
    for strength in strengths:
        if strength.development == law and strength.age_months <= 18:
            by_motor.setdefault((strength.actuator, strength.direction), []).append(sign * strength.ratio)
    steady = sum(ratios == sorted(set(ratios)) for ratios in by_motor.values())
    return f"all {len(by_motor)}" if steady == len(by_motor) else f"{steady} of {len(by_motor)}"


def _strengths(strengths: Sequence[Strength]) -> str:
    ages = list(dict.fromkeys(strength.age_months for strength in strengths))
    ratios = {
        (strength.development, strength.age_months, strength.actuator, strength.direction): strength.ratio
        for strength in strengths
    }
    rows = [
        (law, group, f"`{motor[0]}`", *(f"{ratios[law, age, *motor]:.2f}" for age in ages))
        for law in LAWS
        for group, motor in GROUPS.items()
    ]
    return markdown_table(("law", "group", "motor", *(f"{age:g} months" for age in ages)), rows)


def _rests(rests: Sequence[Rest]) -> str:
    headings = ("law", "months", "hip", "knee", "elbow", "head, upright", "head, leaning back")
    rows = (
        (
            rest.development,
            f"{rest.age_months:g}",
            *(f"{angle:.0f}" for angle in (rest.hip_deg, rest.knee_deg, rest.elbow_deg)),
            *(f"{angle:.0f}" for angle in (rest.head_upright_deg, rest.head_back_deg, *rest.slumps_deg)),
        )
        for rest in rests
    )
    return markdown_table((*headings, *(f"sits from {lean:g}" for lean in LEANS)), rows)


def _rest_verdict(rests: Sequence[Rest]) -> str:
    newborns = {rest.development: rest for rest in rests if rest.age_months == 0}
    flexed = "; ".join(
        f"by `{law}` a newborn's hips, knees and elbows come to rest at {rest.hip_deg:.0f}, {rest.knee_deg:.0f} and "
        f"{rest.elbow_deg:.0f} degrees, and its head, upright, at {rest.head_upright_deg:.0f}"
        for law, rest in newborns.items()
    )
    forward = "; ".join(f"by `{law}` {_forward([rest for rest in rests if rest.development == law])}" for law in LAWS)
    return (
        f"In words: {flexed}. Slack sitters slump forward, {forward}. One whose weight is over its seat falls back by "
        "either law, as its pelvis is round."
    )


def _forward(rests: Sequence[Rest]) -> str:
    parts = (f"from {lean:g} at {_ages(rests, index)}" for index, lean in enumerate(LEANS))
    return ", ".join(parts)


def _ages(rests: Sequence[Rest], index: int) -> str:
    ages = [f"{rest.age_months:g}" for rest in rests if rest.slumps_deg[index] > 0]
    if len(ages) == len(rests):
        return "all ages"
    return f"{', '.join(ages)} months" if ages else "no age"


def _sensitivity_table(findings: Findings) -> str:
    rows = []
    for name in dict.fromkeys(varied.trial for varied in findings.sensitivity):
        ages = {varied.condition: varied.youngest_months for varied in findings.sensitivity if varied.trial == name}
        usual = _youngest(findings.milestones, "maturing", name)
        rows.append((TRIALS[name].title, *map(_months, (usual, *(ages[condition] for condition in VARIATIONS)))))
    return markdown_table(("trial", "as above", *VARIATIONS), rows)


T = TypeVar("T")

AGES: Sequence[float] = (*(half / 2 for half in range(29)), 18, 24)
"""Ages at which milestones are tried: every half month to 14 months, when all of them are reached."""
PUBLISHED_AGES: Sequence[float] = (0, 1, 2, 3, 4, 6, 9, 12, 15, 18, 24)
"""Those of the published law, by which most is possible from birth."""
QUICK_AGES: Sequence[float] = (0, 6, 18)
NAMES, QUICK_NAMES = tuple(TRIALS), ("prone_head", "no_head_lag")
VARIED_NAMES = tuple(trial.name for trial in MILESTONES)
MONTHS: Sequence[float] = (0, 1, 2, 3, 4, 6, 9, 12, 15, 18, 24)
QUICK_MONTHS: Sequence[float] = (0, 6, 18)
COMPARED_MONTHS = 18
"""Age of the reference body, whose strength is 1; one of `MONTHS` and of `QUICK_MONTHS`."""
SITTING_MONTHS, QUICK_SITTING_MONTHS = (0, 3, 6, 9, 12, 18, 24), (0, 18)
OLDEST_SHOWN_MONTHS = 18.0
COLOURS = 128
"""Number of colours of the pictures of infants."""

ATTEMPT_HEADINGS = ("development", "milestone", "age_months", "success", "ended_s", "reason", "posture")
STRENGTH_HEADINGS = ("development", "age_months", "actuator", "direction", "torque_nm", "moment_nm", "ratio")
REST_HEADINGS = (
    "development",
    "age_months",
    "hip_deg",
    "knee_deg",
    "elbow_deg",
    "head_upright_deg",
    "head_leaning_back_deg",
    *(f"slump_from_{lean:g}_deg" for lean in LEANS),
)
SENSITIVITY_HEADINGS = ("milestone", "condition", "age_months")


def run(notebook: Notebook) -> Path:
    """Let infants of many ages try what real infants learn to do, and return the path of the report.

    An interrupted run goes on with the searches that it had not finished, if its folder is the same.
    """
    quick = notebook.quick
    months, sitting = (QUICK_MONTHS, QUICK_SITTING_MONTHS) if quick else (MONTHS, SITTING_MONTHS)
    names = QUICK_NAMES if quick else NAMES
    ages = (
        {"maturing": QUICK_AGES, "published": QUICK_AGES} if quick else {"maturing": AGES, "published": PUBLISHED_AGES}
    )
    varied = [name for name in names if name in VARIED_NAMES]
    total = len(LAWS) * (2 * len(months) + len(sitting) + len(names)) + len(VARIATIONS) * len(varied)
    count = _counter(notebook.progress, total)
    strong = [item for law in LAWS for age in months for item in count(list(strengths(law, age)))]
    _write_strength(notebook, strong)
    resting = [count(rest(law, age)) for law in LAWS for age in months]
    notebook.write_table("rest.csv", REST_HEADINGS, map(_rest_cells, resting))
    sitters = [[count(try_to_sit(law, age)) for age in sitting] for law in LAWS]
    _write_sitters(notebook, sitters)

    def searched(cases: Sequence[Case]) -> Mapping[Case, SearchResult]:
        processes = 1 if quick else os.cpu_count() or 1
        return run_searches(cases, notebook.folder, processes, lambda: count(None))

    measured = searched([Case(law, name, tuple(ages[law]), Conditions()) for law in LAWS for name in names])
    _write_milestones(notebook, measured)
    sensitivity = _sensitivity({case: result for case, result in measured.items() if case.trial in varied}, searched)
    _write_sensitivity(notebook, sensitivity)
    page = _write_page(notebook, Findings(measured, strong, resting, sensitivity))
    forget_searches(notebook.folder)
    return page


def _counter(progress: Progress, total: int) -> Callable[[T], T]:
    """Return a function that counts one step and gives back what it is given."""
    done = 0

    def count(result: T) -> T:
        nonlocal done
        done += 1
        progress(done, total)
        return result

    return count


def _sensitivity(
    usual: Mapping[Case, SearchResult], searched: Callable[[Sequence[Case]], Mapping[Case, SearchResult]]
) -> list[Varied]:
    """Return the ages of milestones under other conditions, searched for from the usual ages of `maturing` on."""
    cases = {
        (case.trial, name): replace(case, conditions=conditions, near_months=measured.youngest_months)
        for case, measured in usual.items()
        if case.development == "maturing" and measured.youngest_months is not None
        for name, conditions in VARIATIONS.items()
    }
    measured = searched(list(cases.values()))
    return [Varied(trial, name, measured[case].youngest_months) for (trial, name), case in cases.items()]


def _write_strength(notebook: Notebook, measured: Sequence[Strength]) -> None:
    rows = (
        (
            item.development,
            item.age_months,
            item.actuator,
            "positive" if item.direction > 0 else "negative",
            item.torque_nm,
            item.moment_nm,
            item.ratio,
        )
        for item in measured
    )
    notebook.write_table("strength.csv", STRENGTH_HEADINGS, rows)
    notebook.write_plots("strength.png", [_strength_plot(measured, law) for law in LAWS])


def _strength_plot(measured: Sequence[Strength], law: str) -> Plot:
    lines = []
    for group, motor in GROUPS.items():
        of_motor = [item for item in measured if item.development == law and (item.actuator, item.direction) == motor]
        at_18 = next(item.ratio for item in of_motor if item.age_months == COMPARED_MONTHS)
        ages, ratios = [item.age_months for item in of_motor], [item.ratio / at_18 for item in of_motor]
        lines.append(Line(ages, ratios, group, "marked"))
    y = Quantity("ratio", "Torque / gravity moment, relative to 18 months")
    return Plot(AGE, y, tuple(lines), title=law, level=1.0)


def _rest_cells(rested: Rest) -> tuple[Cell, ...]:
    *numbers, slumps_deg = astuple(rested)
    return *numbers, *slumps_deg


def _write_sitters(notebook: Notebook, sitters: Sequence[Sequence[Sitter]]) -> None:
    captioned = [[tile_pictures([[item.picture]], columns=[caption(item)]) for item in row] for row in sitters]
    notebook.write_picture("sitting.png", encode_palette_png(tile_pictures(captioned, rows=LAWS), COLOURS))


def _write_milestones(notebook: Notebook, measured: Mapping[Case, SearchResult]) -> None:
    notebook.write_table("attempts.csv", ATTEMPT_HEADINGS, _attempts(measured))
    names = dict.fromkeys(case.trial for case in measured)
    rows = [
        AgeRow(
            name,
            {case.development: result.youngest_months for case, result in measured.items() if case.trial == name},
            (window.youngest_months, window.oldest_months) if (window := WINDOWS.get(name)) else (),
        )
        for name in names
    ]
    notebook.write_picture("milestones.png", _rows_png(rows))


def _rows_png(rows: Sequence[AgeRow]) -> bytes:
    return encode(rows_sheet(rows, "real infants", ages_months=(0.0, OLDEST_SHOWN_MONTHS)))


def _attempts(measured: Mapping[Case, SearchResult]) -> Iterator[tuple[Cell, ...]]:
    for case, result in measured.items():
        for age_months, outcome in result.outcomes.items():
            success = "yes" if outcome.success else "no"
            cells = (success, outcome.seconds, outcome.reason, outcome.strategy)
            yield case.development, case.trial, age_months, *cells


def _write_sensitivity(notebook: Notebook, measured: Sequence[Varied]) -> None:
    rows = ((item.trial, item.condition, item.youngest_months) for item in measured)
    notebook.write_table("sensitivity.csv", SENSITIVITY_HEADINGS, rows)
    shown = [
        AgeRow(name, {item.condition: item.youngest_months for item in measured if item.trial == name})
        for name in dict.fromkeys(item.trial for item in measured)
    ]
    notebook.write_picture("sensitivity.png", _rows_png(shown))
