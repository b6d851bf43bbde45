"""What sets the age of sitting: infants that sit by their own senses, with one factor at a time of another age."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from typing import Any

import mujoco
import numpy as np

from mimoc.base.quantities import AGE, Quantity
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.compiler.building import build
from mimoc.compiler.presets import motor_share
from mimoc.fits.growth import measure
from mimoc.policies.policy import metrics_of
from mimoc.policies.rollout import Run
from mimoc.render.plots import Line, Plot, Sheet
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.studies.comparison import direction, interval, sign_test
from mimoc.studies.experiment import Experiment, Results, child, measures_table
from mimoc.studies.notebook import PAGES, table_rows

MONTHS: Sequence[float] = (5, 6, 8, 12)
SECONDS = 10.0  # How long an infant is to sit: as in WHO's milestone of sitting without support.
SETTLED_S = 1.0  # From when on sway is measured.
CHECKED_STEPS = 10  # Control steps after which a trial is given up if the infant has fallen.
HALF = 0.5  # Share of the seeds that hold at the age of sitting.
NEWBORN_MONTHS, OLDER_MONTHS = 0.0, 24.0

NOISE: Mapping[str, Any] = {"motor": "maturing", "vestibular_thresholds": "age", "proprioception_deg": 0.5}
"""Noise of infants of all ages. Nobody has measured what posture control feels of joints; as much as children err when
they match angles (`age`: 5 degrees at twelve months) lets nobody sit, so that the amount is a choice."""
BY_AGE_DEG = {"newborn": 8.0, "twelve months": 5.0, "adult": 2.0}  # Amounts of `proprioception_deg: age`; guesses.

OWN = "own age"
NEWBORN, OLDER, NONE = "newborn's", "24 months' or adult's", "none"
LAGS_WEEKS: Mapping[str, float] = {"weight of 4 weeks ago": 4.0, "weight of 26 weeks ago": 26.0}
LEVELS: Mapping[str, Sequence[str]] = {
    "strength": (NEWBORN, OLDER),
    "delays": (NEWBORN, OLDER, NONE),
    "noise of senses": (NEWBORN, OLDER, NONE),
    "noise of commands": (NEWBORN, OLDER, NONE),
    "proportions": (NEWBORN, OLDER),
    "forward model": tuple(LAGS_WEEKS),
}
"""What each factor is set to while the others have the infant's own age."""
HARDER = (NEWBORN, *LAGS_WEEKS)  # With these, sitting is expected to be harder than at the own age.
WITHOUT_PARTS = ("middle_finger_diameter", "rump_sole_length", "thumb_diameter")
"""Measurements that nothing of a body with mittens follows."""
AXIAL = ("trunk", "neck", "legs")  # Groups of muscles whose strength is kept in proportion to the weight.
HELD = Quantity("held_s", "Sits for", "s")
SWAY = Quantity("sway_mm", "Sway (RMS)", "mm")
LEAST_S = 0.5  # Mean change that counts as one (a choice).
MOST_SWAY_MM = 20.0  # End of the axis; infants that sway more are falling.


@dataclass(frozen=True, slots=True)
class Case:
    """An infant of an age of which one factor is of another."""

    age_months: float
    factor: str = OWN
    level: str = ""


def cases(months: Sequence[float]) -> list[Case]:
    """Return infants of some ages, as they are and with each factor at each of its levels."""
    changed = [(factor, level) for factor, levels in LEVELS.items() for level in levels]
    return [Case(age, *what) for what in [(OWN, ""), *changed] for age in months]


def sit(case: Case, seed: int) -> dict[str, float]:
    """Let an infant sit; return for how long it does, and by how much it sways until then."""
    with closing(InfantEnv(infant(case))) as env:
        run = Run(env, policy(case), seed)
        data, hip = env.data, env.model.body(env.manifest.root_body).id
        step_s = ms_to_s(env.manifest.step_ms)
        places_m = list[np.ndarray]()
        for step in range(round(SECONDS / step_s)):
            run.step()
            places_m.append(data.subtree_com[hip][:2].copy())
            if step % CHECKED_STEPS == 0 and not metrics_of(run.policies[""])["held_share"]:
                break
        metrics = run.summary().metrics
    values = {"held_s": metrics["held_s"], "holds": metrics["held_share"]}
    seen_m = np.array(places_m)[round(SETTLED_S / step_s) : round(metrics["held_s"] / step_s)]
    if len(seen_m) * step_s >= SETTLED_S:
        values["sway_mm"] = 1000 * float(np.sqrt(seen_m.var(axis=0).sum()))
    return values


def policy(case: Case) -> str:
    """Return the policy of a case."""
    return f"sit(lag_weeks={LAGS_WEEKS[case.level]:g})" if case.level in LAGS_WEEKS else "sit"


@cache
def infant(case: Case) -> Bundle:
    """Return the infant of a case, whose delays may be those of an infant of another age."""
    bundle = build(spec_of(case))
    if case.factor != "delays" or case.level == NONE:
        return bundle
    other = infant(Case(_other_months(case.level)))
    manifest = bundle.manifest.model_copy(update={"delays": other.manifest.delays})
    return Bundle(bundle.files, manifest, None)


def spec_of(case: Case) -> InfantSpec:
    """Return the spec of a case."""
    keys: dict[str, Any] = {
        "senses": {"proprioception": {}, "vestibular": {}},
        "scene": {"kind": "flat", "pose": "sitting"},
        "delays": {"preset": "none" if (case.factor, case.level) == ("delays", NONE) else "physiological"},
        "noise": {**NOISE, **_noise(case)},
    }
    if case.factor == "strength":
        keys["actuation"] = {"strength_age_months": _other_months(case.level)}
    if case.factor == "proportions":
        keys["body"] = {"measurements": proportions_cm(case.age_months, _other_months(case.level))}
        usual, other = (_strengths(build(child("sitting", case.age_months, **more))) for more in ({}, keys))
        keys["actuation"] = {"strength": {group: usual[group] / other[group] for group in usual}}
    return child("sitting", case.age_months, **keys)


def proportions_cm(age_months: float, other_months: float) -> dict[str, float]:
    """Return the measurements of the average child of another age, scaled to the length of a child of this one."""
    own_m, other_m = measure(age_months), measure(other_months)
    scale = own_m["crown_sole_length"] / other_m["crown_sole_length"]
    return {f"{name}_cm": round(100 * scale * other_m[name], 2) for name in other_m if name not in WITHOUT_PARTS}


def _other_months(level: str) -> float:
    return NEWBORN_MONTHS if level == NEWBORN else OLDER_MONTHS


def _noise(case: Case) -> dict[str, Any]:
    """Return the keys of noise in which a case differs."""
    if case.factor == "noise of commands":
        return {"motor": 0.0 if case.level == NONE else round(motor_share(_other_months(case.level)), 4)}
    if case.factor != "noise of senses":
        return {}
    if case.level == NONE:
        return {"proprioception_deg": 0.0, "vestibular_thresholds": 0.0}
    whose = "newborn" if case.level == NEWBORN else "adult"
    scaled_deg = NOISE["proprioception_deg"] * BY_AGE_DEG[whose] / BY_AGE_DEG["twelve months"]
    thresholds = 1.0 if case.level == NEWBORN else "adult"
    return {"proprioception_deg": round(scaled_deg, 4), "vestibular_thresholds": thresholds}


def _strengths(bundle: Bundle) -> dict[str, float]:
    """Return the sum of the strengths of each group of muscles over the weight, [N m/kg]."""
    model, groups = load_model(bundle), bundle.manifest.anatomy.groups
    mass_kg = float(model.body_mass.sum())
    strengths = dict[str, float]()
    for name in AXIAL:
        members = [joint for group, joints in groups.items() if group.endswith(name.rstrip("s")) for joint in joints]
        hinges = [model.joint(joint).id for joint in members]
        driven = np.isin(model.actuator_trnid[:, 0], hinges) & (model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT)
        strengths[name] = float(np.abs(model.actuator_gear[driven, 0]).sum()) / mass_kg
    return strengths


# What is shown.


@dataclass(frozen=True, slots=True)
class Effect:
    """What a factor at a level does to sitting, over all ages and seeds, each pair with the same."""

    changes_s: Sequence[float]  # By how much longer than at the own age it sits, of each pair.
    harder: bool  # Whether it is expected to be harder.

    @property
    def verdict(self) -> str:
        """Whether a sign test shows the direction that is expected."""
        found = direction(self.changes_s, LEAST_S)
        expected, other = ("less", "more") if self.harder else ("more", "less")
        words = {expected: "as expected", other: "the other way", "unclear": "too few trials"}
        return words.get(found, "not shown")

    @property
    def chance(self) -> float:
        """Probability that so many pairs go the expected way by chance."""
        return sign_test([-change if self.harder else change for change in self.changes_s])


def effect(results: Results, factor: str, level: str) -> Effect:
    """Return the effect of a factor at a level."""
    return Effect(changes(results, factor, level, "held_s"), level in HARDER)


def changes(results: Results, factor: str, level: str, measure: str) -> list[float]:
    """Return by how much a measure is larger than at the own age, of each age and seed that has both."""
    return [
        other.values[measure] - own.values[measure]
        for age in _months(results)
        for own, other in zip(results.by_case[Case(age)], results.by_case[Case(age, factor, level)], strict=True)
        if measure in own.values and measure in other.values
    ]


def sitting_months(results: Results, factor: str = OWN, level: str = "") -> float | None:
    """Return the youngest tried age at which at least half of the seeds sit to the end; None if there is none."""
    for age in _months(results):
        if np.mean(results.values(Case(age, factor, level), "holds")) >= HALF:
            return age
    return None


def _months(results: Results) -> list[float]:
    return list(dict.fromkeys(case.age_months for case in results.by_case))


def _conditions(results: Results) -> list[tuple[str, str]]:
    return list(dict.fromkeys((case.factor, case.level) for case in results.by_case))


def _plots(results: Results) -> Sheet:
    plots, months = list[Plot](), _months(results)

    def line(measure: str, factor: str, level: str) -> Line:
        known = [age for age in months if results.values(Case(age, factor, level), measure)]
        return Line(known, [results.mean(Case(age, factor, level), measure).mean for age in known], level or OWN)

    for quantity, most in ((HELD, 1.05 * SECONDS), (SWAY, MOST_SWAY_MM)):
        for factor in dict.fromkeys(factor for factor, _ in _conditions(results) if factor != OWN):
            levels = [level for other, level in _conditions(results) if other == factor]
            shown = [(OWN, ""), *((factor, level) for level in levels)]
            lines = tuple(line(quantity.name, *what) for what in shown)
            plots.append(Plot(AGE, quantity, lines, title=factor.capitalize(), y_range=(0.0, most)))
    return Sheet(tuple(plots), columns=3, panel_px=(520, 380), shared_legend=True)


def _numbers(results: Results) -> dict[str, object]:
    months = _months(results)
    return {
        "months": ", ".join(f"{age:g}" for age in months),
        "seconds": f"{SECONDS:g}",
        "noise_deg": f"{NOISE['proprioception_deg']:g}",
        "headings": " | ".join(f"{age:g} mo" for age in months),
        "rules": " | ".join("---" for _ in months),
        "table": table_rows(_rows(results)),
        "sway": table_rows(_sway(results)),
        "effects": table_rows(_effects(results)),
        "answer": _answer(results),
    }


def _age_text(age_months: float | None) -> str:
    return "none of these" if age_months is None else f"{age_months:g}"


def _named(factor: str, level: str) -> str:
    return f"{factor}: {level}" if level else factor


def _rows(results: Results) -> Iterator[tuple[str, ...]]:
    for factor, level in _conditions(results):
        cells = list[str]()
        for age in _months(results):
            case = Case(age, factor, level)
            holding = round(sum(results.values(case, "holds")))
            sway_mm = results.values(case, "sway_mm")
            sway = f", {np.mean(sway_mm):.1f} mm" if sway_mm else ""
            cells.append(f"{np.mean(results.values(case, 'held_s')):.1f} s, {holding}/{len(results.seeds)}{sway}")
        yield _named(factor, level), _age_text(sitting_months(results, factor, level)), *cells


def _sway(results: Results) -> Iterator[tuple[str, ...]]:
    for age in _months(results):
        values = results.values(Case(age), "sway_mm")
        held = results.mean(Case(age), "held_s").text(1)
        sway = f"{interval(values).text(1)}, n = {len(values)}" if values else "falls too soon"
        yield f"{age:g}", held, sway


def _effects(results: Results) -> Iterator[tuple[str, ...]]:
    for factor, level in _conditions(results):
        if factor != OWN:
            found = effect(results, factor, level)
            expected = "shorter, later" if found.harder else "longer, earlier"
            mean = interval(found.changes_s).text(1)
            shift = _shift(sitting_months(results), sitting_months(results, factor, level))
            sway_mm = changes(results, factor, level, "sway_mm")
            sway = f"{interval(sway_mm).text(1)}, n = {len(sway_mm)}" if sway_mm else "-"
            yield _named(factor, level), expected, mean, f"{found.chance:.2g}", found.verdict, shift, sway


SAME = "the same"


def _shift(own: float | None, other: float | None) -> str:
    if own == other:
        return SAME
    later = own is not None and (other is None or other > own)
    return f"{'later' if later else 'earlier'} ({_age_text(other)})"


def _answer(results: Results) -> str:
    """Return which factors move sitting most, of those whose direction is shown."""
    found = {what: effect(results, *what) for what in _conditions(results) if what[0] != OWN}
    shown = {what: np.mean(one.changes_s) for what, one in found.items() if one.verdict == "as expected"}
    own = sitting_months(results)
    start = (
        f"With all of their own age, half of the infants sit for {SECONDS:g} s from {own:g} months on."
        if own is not None
        else f"With all of their own age, at none of these ages half of the infants sit for {SECONDS:g} s."
    )
    if not shown:
        return f"{start} No factor is shown to move this, by a sign test over all ages and seeds (p < .05)."
    moved = {what: _shift(own, sitting_months(results, *what)) for what in found}
    ages = "; ".join(f"{_named(*what)}: {shift}" for what, shift in moved.items() if shift != SAME)
    start = f"{start} Of all that is changed, this age is moved by {ages or 'nothing'}."
    ranked = sorted(shown.items(), key=lambda item: -abs(item[1]))
    told = "; ".join(f"{_named(*what)} ({change:+.1f} s)" for what, change in ranked)
    return f"{start} What moves the time for which they sit, the most first (mean over all ages and seeds): {told}."


EXPERIMENT = Experiment(
    name="sitting",
    trial=sit,
    cases=cases(MONTHS),
    seeds=range(5),
    quick={"seeds": range(1), "cases": cases((6, 12))},
    files={
        "sitting.csv": measures_table(age_months="age_months", factor="factor", level="level"),
        "sitting.png": _plots,
    },
    page=PAGES / "sitting.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: (infant(Case(age_months)) for age_months in MONTHS),
)
