"""Motor development from birth to two years: milestones, strength, posture at rest, and how much they hang on."""

import os
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import astuple, dataclass, replace
from typing import Any

import mujoco
import numpy as np

from mimoc.base.quantities import AGE, Quantity
from mimoc.compiler.looks.pictures import encode_palette_png
from mimoc.compiler.measuring import ROOT
from mimoc.policies.control.postures import seat
from mimoc.render.body_camera import BodyCamera
from mimoc.render.picture_files import Picture, tile_pictures
from mimoc.render.plots import Line, Plot, Sheet
from mimoc.render.soft_light import STILL
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Table
from mimoc.studies.experiments.strength import GROUPS, Strength, strengths
from mimoc.studies.growth_plots import AgeRow, rows_sheet
from mimoc.studies.jobs import JobStore
from mimoc.studies.milestones import WINDOWS
from mimoc.studies.milestones.search import FOLDER, Case, SearchResult, run_searches
from mimoc.studies.milestones.trial import Conditions, Outcome, TrialInfant, compile_at, simulate
from mimoc.studies.milestones.trials import MILESTONES, TRIALS
from mimoc.studies.notebook import PAGES, Notebook, markdown_table, table_rows

LYING_S, FALLING_S = 6.0, 3.0
ON_THE_BACK_DEG, LEANING_BACK_DEG, UPRIGHT_DEG = -90.0, -45.0, 0.0
BENT_DEG = {"{side}_hip1": -50.0, "{side}_hip2": -25.0, "{side}_knee": -70.0, "{side}_elbow": -60.0}
"""The posture in which an infant is laid down, its arms away from its body: that of mimoc's pose `supine`."""
ARMS_DEG = 60.0
ABOVE_M = 1.0  # Height at which a trunk is held, so that nothing touches the floor.
LEANS = (0.15, 0.25, 0.35, 0.45)
"""Where the weight of a sitting infant stands at first: 0 over the seat, 1 over the heels."""
SITTING_KNEE_DEG = -20.0


@dataclass(frozen=True, slots=True)
class Rest:
    """Where an infant without commands comes to rest."""

    development: Development
    age_months: float
    hip_deg: float  # Lying on its back; below 0 is bent, as for knee and elbow.
    knee_deg: float
    elbow_deg: float
    head_upright_deg: float  # Angle of the head with the trunk held upright; above 0, the chin has fallen to the chest.
    head_back_deg: float  # The same with the trunk leaning back by 45 degrees; below 0, the head has fallen back.
    slumps_deg: Sequence[float]
    """Tilt of the chest after sitting, for each of `LEANS`; above 0 forward, about 90 is lying."""


def rest(development: Development, age_months: float) -> Rest:
    """Return where the average child of an age comes to rest."""
    infant = _average_child(development, age_months)
    lying = infant.placed(ON_THE_BACK_DEG, {**BENT_DEG, "{side}_shoulder_ad_ab": ARMS_DEG})
    lying = _after(infant, lying, LYING_S)
    return Rest(
        development,
        age_months,
        hip_deg=_angle_deg(infant, lying, "left_hip1"),
        knee_deg=_angle_deg(infant, lying, "left_knee"),
        elbow_deg=_angle_deg(infant, lying, "left_elbow"),
        head_upright_deg=_head_deg(infant, UPRIGHT_DEG),
        head_back_deg=_head_deg(infant, LEANING_BACK_DEG),
        slumps_deg=[_slump_deg(infant, lean) for lean in LEANS],
    )


def _average_child(development: Development, age_months: float) -> TrialInfant:
    spec = InfantSpec(mimoc=1, name="average_child", age_months=age_months, development=development)
    return compile_at(spec, age_months, Conditions())


def _head_deg(infant: TrialInfant, pitch_deg: float) -> float:
    held = infant.fixed(infant.trunk_dofs())
    return _angle_deg(held, _after(held, held.placed(pitch_deg, {}, ABOVE_M), FALLING_S), "head_tilt")


def _slump_deg(infant: TrialInfant, lean: float) -> float:
    """Return the tilt of the chest of a slack infant that sat with its weight over some point."""
    data = _after(infant, seat(infant, SITTING_KNEE_DEG, lean), FALLING_S)
    forward, _, up = data.xmat[infant.pushed].reshape(3, 3)[:, 2]
    return float(np.degrees(np.arctan2(forward, up)))


def _after(infant: TrialInfant, data: mujoco.MjData, seconds: float) -> mujoco.MjData:
    for _ in range(round(seconds / infant.model.opt.timestep)):
        mujoco.mj_step(infant.model, data)
    return data


def _angle_deg(infant: TrialInfant, data: mujoco.MjData, joint: str) -> float:
    address = infant.model.joint(f"robot:{joint}").qposadr[0]
    return float(np.degrees(data.qpos[address]))


PICTURE_PX = (150, 150)


def try_to_sit(development: Development, age_months: float) -> Picture:
    """Let the average child of an age try to sit, and show how its longest attempt ended."""
    infant = _average_child(development, age_months)
    best, outcome = mujoco.MjData(infant.model), Outcome(False, -1.0)
    for attempt in TRIALS["sit"].attempts(infant):
        states = deque[mujoco.MjData](maxlen=1)
        ended = simulate(attempt, Conditions(), states.append)
        if ended.seconds > outcome.seconds:
            best, outcome = states[0], ended
        if outcome.success:
            break
    with closing(BodyCamera(infant.model, [ROOT], *PICTURE_PX, exposure=STILL)) as camera:
        held = "sits" if outcome.success else f"falls after {outcome.seconds:.1f} s"
        return tile_pictures([[camera.render(best)]], columns=[f"{age_months:g} months: {held}"])


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


@dataclass(frozen=True, slots=True)
class Measures:
    """What was measured of infants by both laws."""

    strengths: Motors
    rests: Sequence[Rest]
    sitting: Sequence[Sequence[Picture]]  # How infants try to sit, by law and age.
    searches: Mapping[Case, SearchResult]
    reached: Reached
    sensitivity: Reached


def measure(notebook: Notebook) -> Measures:
    """Let infants of many ages try what real infants learn to do."""
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
    motors: dict[tuple[str, str, int], list[Strength]] = {}
    for law in LAWS:
        for age in months:
            for item in count(list(strengths(law, age))):
                motors.setdefault((law, item.actuator, item.direction), []).append(item)
    rests = [count(rest(law, age)) for law in LAWS for age in months]
    sitters = [[count(try_to_sit(law, age)) for age in sitting] for law in LAWS]

    def searched(cases: Sequence[Case]) -> Mapping[Case, SearchResult]:
        return run_searches(cases, notebook.folder, 1 if quick else os.cpu_count() or 1, count)

    results = searched(list(cases.values()))
    reached = {name: {law: results[cases[law, name]].youngest_months for law in LAWS} for name in names}
    sensitivity = _vary({name: cases["maturing", name] for name in varied}, reached, searched)
    JobStore(notebook.folder, FOLDER, SearchResult).clear()
    return Measures(motors, rests, sitters, results, reached, sensitivity)


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


def _strength_table(found: Measures) -> Table:
    directions = {1: "positive", -1: "negative"}
    months = dict.fromkeys(it.age_months for motor in found.strengths.values() for it in motor)
    rows = (
        (it.development, it.age_months, it.actuator, directions[it.direction], it.torque_nm, it.moment_nm, it.ratio)
        for law in LAWS
        for age in months
        for motor in found.strengths.values()
        for it in motor
        if (it.development, it.age_months) == (law, age)
    )
    return "development,age_months,actuator,direction,torque_nm,moment_nm,ratio", rows


def _rest_table(found: Measures) -> Table:
    slumps = ",".join(f"slump_from_{lean:g}_deg" for lean in LEANS)
    heading = f"development,age_months,hip_deg,knee_deg,elbow_deg,head_upright_deg,head_leaning_back_deg,{slumps}"
    return heading, map(_rest_cells, found.rests)


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


def _attempts(found: Measures) -> Table:
    return "development,milestone,age_months,success,ended_s,reason,posture", (
        (case.development, case.trial, age, "yes" if it.success else "no", it.seconds, it.reason, it.strategy)
        for case, result in found.searches.items()
        if case.conditions == Conditions()
        for age, it in result.outcomes.items()
    )


def _milestone_sheet(found: Measures) -> Sheet:
    windows = {name: (window.youngest_months, window.oldest_months) for name, window in WINDOWS.items()}
    return _rows_sheet([AgeRow(name, by_law, windows.get(name, ())) for name, by_law in found.reached.items()])


def _sensitivity_table(found: Measures) -> Table:
    rows = ((name, *item) for name, by_condition in found.sensitivity.items() for item in by_condition.items())
    return "milestone,condition,age_months", rows


def _rows_sheet(rows: Sequence[AgeRow]) -> Sheet:
    return rows_sheet(rows, "real infants", ages_months=(0.0, OLDEST_SHOWN_MONTHS))


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


EXPERIMENT = Experiment(
    name="development",
    measure=measure,
    files={
        "strength.csv": _strength_table,
        "strength.png": lambda found: [_strength_plot(found.strengths, law) for law in LAWS],
        "rest.csv": _rest_table,
        "sitting.png": lambda found: encode_palette_png(tile_pictures(found.sitting, rows=LAWS), COLOURS),
        "attempts.csv": _attempts,
        "milestones.png": _milestone_sheet,
        "sensitivity.csv": _sensitivity_table,
        "sensitivity.png": lambda found: _rows_sheet([AgeRow(name, ages) for name, ages in found.sensitivity.items()]),
    },
    page=PAGES / "development.md",
    numbers=lambda found: {
        "milestones": _milestones(found.reached),
        "rising": _steady(found.strengths, "maturing", 1),
        "falling": _steady(found.strengths, "published", -1),
        "strengths": _strengths(found.strengths),
        **_rests(found.rests),
        "sensitivity": _sensitivity(found.reached, found.sensitivity),
    },
    infants=infants,
)
