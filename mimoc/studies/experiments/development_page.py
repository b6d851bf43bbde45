"""The report on motor development."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mimoc.schema.names import Development
from mimoc.studies.experiments.milestone_searches import Case
from mimoc.studies.experiments.notebook import Notebook, markdown_table, page_texts
from mimoc.studies.experiments.resting import FALLING_S, LEANS, LYING_S, Rest
from mimoc.studies.experiments.strength_over_load import GROUPS, Strength
from mimoc.studies.milestones import TRIALS, WINDOWS, Conditions
from mimoc.studies.milestones.search import SearchResult

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


def write(notebook: Notebook, findings: Findings) -> Path:
    """Write the report, and return its path."""
    sections = (
        TEXTS["about"],
        TEXTS["milestones"].format(table=_milestones(findings.milestones)),
        TEXTS["strength"].format(verdict=_strength_verdict(findings.strengths), table=_strengths(findings.strengths)),
        TEXTS["rest"].format(
            lying_s=LYING_S, falling_s=FALLING_S, table=_rests(findings.rests), verdict=_rest_verdict(findings.rests)
        ),
        TEXTS["sitting"],
        TEXTS["sensitivity"].format(table=_sensitivity(findings)),
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


def _sensitivity(findings: Findings) -> str:
    rows = []
    for name in dict.fromkeys(varied.trial for varied in findings.sensitivity):
        ages = {varied.condition: varied.youngest_months for varied in findings.sensitivity if varied.trial == name}
        usual = _youngest(findings.milestones, "maturing", name)
        rows.append((TRIALS[name].title, *map(_months, (usual, *(ages[condition] for condition in VARIATIONS)))))
    return markdown_table(("trial", "as above", *VARIATIONS), rows)
