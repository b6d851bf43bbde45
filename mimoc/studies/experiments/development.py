"""Motor development from birth to two years: milestones, strength, posture at rest, and how much they hang on."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from mimoc.looks.pictures import encode_palette_png
from mimoc.quantities import Quantity
from mimoc.quantities.child import AGE
from mimoc.render.picture_files import tile_pictures
from mimoc.render.plots.file import encode
from mimoc.render.plots.milestones import AgeRow, rows_sheet
from mimoc.render.plots.plot import Line, Plot
from mimoc.studies.experiments import development_page
from mimoc.studies.experiments.development_page import LAWS, VARIATIONS, Findings, Varied
from mimoc.studies.experiments.milestone_searches import Case, forget_searches, run_searches
from mimoc.studies.experiments.notebook import Cell, Notebook, Progress
from mimoc.studies.experiments.resting import LEANS, Rest, rest
from mimoc.studies.experiments.sitting_pictures import Sitter, caption, try_to_sit
from mimoc.studies.experiments.strength_over_load import GROUPS, Strength, strengths
from mimoc.studies.milestones import MILESTONES, TRIALS, WINDOWS, Conditions
from mimoc.studies.milestones.search import SearchResult

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
    strong = [each for law in LAWS for age in months for each in count(list(strengths(law, age)))]
    _write_strength(notebook, strong)
    resting = [count(rest(law, age)) for law in LAWS for age in months]
    notebook.write_table("rest.csv", REST_HEADINGS, map(_rest_cells, resting))
    sitters = [[count(try_to_sit(law, age)) for age in sitting] for law in LAWS]
    _write_sitters(notebook, sitters)

    def searched(cases: Sequence[Case]) -> Mapping[Case, SearchResult]:
        processes = 1 if quick else os.cpu_count() or 1
        return run_searches(cases, notebook.folder, processes, lambda: count(None))

    found = searched([Case(law, name, tuple(ages[law]), Conditions()) for law in LAWS for name in names])
    _write_milestones(notebook, found)
    sensitivity = _sensitivity({case: result for case, result in found.items() if case.trial in varied}, searched)
    _write_sensitivity(notebook, sensitivity)
    page = development_page.write(notebook, Findings(found, strong, resting, sensitivity))
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
        (case.trial, name): replace(case, conditions=conditions, near_months=found.youngest_months)
        for case, found in usual.items()
        if case.development == "maturing" and found.youngest_months is not None
        for name, conditions in VARIATIONS.items()
    }
    found = searched(list(cases.values()))
    return [Varied(trial, name, found[case].youngest_months) for (trial, name), case in cases.items()]


def _write_strength(notebook: Notebook, found: Sequence[Strength]) -> None:
    rows = (
        (
            each.development,
            each.age_months,
            each.actuator,
            "positive" if each.direction > 0 else "negative",
            each.torque_nm,
            each.moment_nm,
            each.ratio,
        )
        for each in found
    )
    notebook.write_table("strength.csv", STRENGTH_HEADINGS, rows)
    notebook.write_plots("strength.png", [_strength_plot(found, law) for law in LAWS])


def _strength_plot(found: Sequence[Strength], law: str) -> Plot:
    lines = []
    for group, motor in GROUPS.items():
        own = [each for each in found if each.development == law and (each.actuator, each.direction) == motor]
        at_18 = next(each.ratio for each in own if each.age_months == COMPARED_MONTHS)
        ages, ratios = [each.age_months for each in own], [each.ratio / at_18 for each in own]
        lines.append(Line(ages, ratios, group, "marked"))
    y = Quantity("ratio", "Torque / gravity moment, relative to 18 months")
    return Plot(AGE, y, tuple(lines), title=law, level=1.0)


def _rest_cells(found: Rest) -> tuple[Cell, ...]:
    return (
        found.development,
        found.age_months,
        found.hip_deg,
        found.knee_deg,
        found.elbow_deg,
        found.head_upright_deg,
        found.head_back_deg,
        *found.slumps_deg,
    )


def _write_sitters(notebook: Notebook, sitters: Sequence[Sequence[Sitter]]) -> None:
    captioned = [[tile_pictures([[each.picture]], columns=[caption(each)]) for each in row] for row in sitters]
    notebook.write_picture("sitting.png", encode_palette_png(tile_pictures(captioned, rows=LAWS), COLOURS))


def _write_milestones(notebook: Notebook, found: Mapping[Case, SearchResult]) -> None:
    notebook.write_table("attempts.csv", ATTEMPT_HEADINGS, _attempts(found))
    names = dict.fromkeys(case.trial for case in found)
    rows = [
        AgeRow(
            name,
            {case.development: result.youngest_months for case, result in found.items() if case.trial == name},
            (window.youngest_months, window.oldest_months) if (window := WINDOWS.get(name)) else (),
        )
        for name in names
    ]
    notebook.write_picture("milestones.png", _rows_png(rows))


def _rows_png(rows: Sequence[AgeRow]) -> bytes:
    return encode(rows_sheet(rows, "real infants", ages_months=(0.0, OLDEST_SHOWN_MONTHS)))


def _attempts(found: Mapping[Case, SearchResult]) -> Iterator[tuple[Cell, ...]]:
    for case, result in found.items():
        for age_months, outcome in result.outcomes.items():
            success = "yes" if outcome.success else "no"
            told = (success, outcome.seconds, outcome.reason, outcome.strategy)
            yield case.development, case.trial, age_months, *told


def _write_sensitivity(notebook: Notebook, found: Sequence[Varied]) -> None:
    rows = ((each.trial, each.condition, each.youngest_months) for each in found)
    notebook.write_table("sensitivity.csv", SENSITIVITY_HEADINGS, rows)
    shown = [
        AgeRow(name, {each.condition: each.youngest_months for each in found if each.trial == name})
        for name in dict.fromkeys(each.trial for each in found)
    ]
    notebook.write_picture("sensitivity.png", _rows_png(shown))
