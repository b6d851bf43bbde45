"""The report on motor development."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mimoc.experiments.milestone_searches import Case
from mimoc.experiments.notebook import Notebook, markdown_table
from mimoc.experiments.resting import FALLING_S, LEANS, LYING_S, Rest
from mimoc.experiments.strength_over_load import GROUPS, Strength
from mimoc.milestones import TRIALS, WINDOWS, Conditions
from mimoc.milestones.search import SearchResult
from mimoc.schema.names import Development

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


ABOUT = """\
Infants of many ages, from birth to two years, try what real infants learn to do, by both laws that mimoc knows:
`maturing`, the default, and `published`, the law of the paper (López et al. 2025), by which gears follow the volume of
body parts and springs, damping and ranges are those of 18 months at every age. All are average children with torque
actuation. `docs/development.md` describes the laws, `docs/milestones.md` the trials and their controller."""

MILESTONES = """\
## Milestones

Youngest age from which on each trial succeeds at all older ages that were tried, in months: every half
month at first by `maturing`, fewer ages by `published`.

![Ages of milestones by both laws, beside those of real infants](milestones.png)

{table}

`attempts.csv` has every attempt, with the time and the reason of its failure."""

STRENGTH = """\
## Strength over load

Largest torque of a motor by the gravity moment of all that hangs on its joint, stretched out level: below 1, an infant
cannot lift it. {verdict}

![Torque by gravity moment of each group, by age and law](strength.png)

{table}

`strength.csv` has all motors but those of the eyes. Hands and feet weigh so little that their motors lift far more than
them; what limits ankles is the body above."""

REST = """\
## Posture at rest

Without commands: angles after {lying_s:g} s on the back (0 is straight, below 0 bent); angle of the head after
{falling_s:g} s, with the trunk held upright and leaning back by 45 degrees; and tilt of the chest {falling_s:g} s after
sitting with the weight over a point between seat (0) and heels (1), where above 0 is forward. All angles in degrees.

{table}

{verdict} None of this was fitted. `rest.csv` has all ages and postures."""

SITTING = """\
## Trying to sit

The end of each infant's longest attempt to sit for ten seconds against pushes of 3 % of its weight: sitting, or as
hands, trunk or head touch the floor or tilt by 45 degrees.

![Infants that try to sit, by age and law](sitting.png)"""

SENSITIVITY = """\
## How much the ages hang on

Ages by `maturing` in months, under other conditions: a faster or slower servo of the controller, all torque limits
changed by 15 %, weaker or stronger pushes while sitting and standing (the usual ones are 0.03 body weights). From the
usual age, younger ages were tried until one failed, or older ones until one succeeded.

![Ages of milestones under other conditions](sensitivity.png)

{table}

`sensitivity.csv` has the same ages."""

LIMITS = """\
## What this shows, and what it does not

The strength curves of `maturing` **were fitted** to these milestones with this controller, as no dynamometry of infants
exists: that milestones come in order and inside the windows of real infants is a reproduction, not a prediction. The
steps by which joints and masses follow age come from publications or from the rule that passive torques keep their
proportion to gravity. **Not fitted**, and so a test of the law, are: the posture at rest, which limbs stay bent and
until when; that heads without support fall; from where on a slack sitter slumps forward; how
the lag of the head decreases from month to month; and how long reaches take.

**Much hangs on the controller.** It knows the infant's own weight and springs, has no delays unless asked for, and does
not learn. A servo that is slower by a fifth, or stronger pushes, can move standing by months: real balance is limited
by delay, noise and skill, of which this controller has none. An age here says from when on a milestone is possible with
the strength of that age, not when a given policy learns it."""


def write(notebook: Notebook, findings: Findings) -> Path:
    """Write the report, and return its path."""
    sections = (
        ABOUT,
        MILESTONES.format(table=_milestones(findings.milestones)),
        STRENGTH.format(verdict=_strength_verdict(findings.strengths), table=_strengths(findings.strengths)),
        REST.format(
            lying_s=LYING_S, falling_s=FALLING_S, table=_rests(findings.rests), verdict=_rest_verdict(findings.rests)
        ),
        SITTING,
        SENSITIVITY.format(table=_sensitivity(findings)),
        LIMITS,
    )
    return notebook.write_page("Motor development", sections, seeds="Nothing is random.", libraries=["matplotlib"])


def _milestones(found: Mapping[Case, SearchResult]) -> str:
    rows = []
    for name in dict.fromkeys(case.trial for case in found):
        ages = [_months(_youngest(found, law, name)) for law in LAWS]
        window = WINDOWS.get(name)
        real = f"{window.youngest_months:g} to {window.oldest_months:g} ({window.span})" if window else "not known"
        rows.append((TRIALS[name].title, *ages, real, window.source if window else ""))
    return markdown_table(("trial", *LAWS, "real infants", "source"), rows)


def _youngest(found: Mapping[Case, SearchResult], law: str, trial: str) -> float | None:
    own = (result for case, result in found.items() if (case.development, case.trial) == (law, trial))
    return next(own).youngest_months


def _months(age_months: float | None) -> str:
    return "not reached" if age_months is None else f"{age_months:g}"


def _strength_verdict(found: Sequence[Strength]) -> str:
    rising, falling = (_steady(found, law, sign) for law, sign in zip(LAWS, (1, -1), strict=True))
    return (
        f"From birth to 18 months, by `maturing` it rises from each age to the next for {rising} motors and directions,"
        f" by `published` it falls for {falling}."
    )


def _steady(found: Sequence[Strength], law: str, sign: int) -> str:
    """Return for how many motors and directions the ratio only rises, or only falls, from birth to 18 months."""
    by_motor: dict[tuple[str, int], list[float]] = {}
    for each in found:
        if each.development == law and each.age_months <= 18:
            by_motor.setdefault((each.actuator, each.direction), []).append(sign * each.ratio)
    steady = sum(ratios == sorted(set(ratios)) for ratios in by_motor.values())
    return f"all {len(by_motor)}" if steady == len(by_motor) else f"{steady} of {len(by_motor)}"


def _strengths(found: Sequence[Strength]) -> str:
    ages = list(dict.fromkeys(each.age_months for each in found))
    ratios = {(each.development, each.age_months, each.actuator, each.direction): each.ratio for each in found}
    rows = [
        (law, group, f"`{motor[0]}`", *(f"{ratios[law, age, *motor]:.2f}" for age in ages))
        for law in LAWS
        for group, motor in GROUPS.items()
    ]
    return markdown_table(("law", "group", "motor", *(f"{age:g} months" for age in ages)), rows)


def _rests(found: Sequence[Rest]) -> str:
    headings = ("law", "months", "hip", "knee", "elbow", "head, upright", "head, leaning back")
    rows = (
        (
            each.development,
            f"{each.age_months:g}",
            *(f"{angle:.0f}" for angle in (each.hip_deg, each.knee_deg, each.elbow_deg)),
            *(f"{angle:.0f}" for angle in (each.head_upright_deg, each.head_back_deg, *each.slumps_deg)),
        )
        for each in found
    )
    return markdown_table((*headings, *(f"sits from {lean:g}" for lean in LEANS)), rows)


def _rest_verdict(found: Sequence[Rest]) -> str:
    newborns = {each.development: each for each in found if each.age_months == 0}
    flexed = "; ".join(
        f"by `{law}` a newborn's hips, knees and elbows come to rest at {each.hip_deg:.0f}, {each.knee_deg:.0f} and "
        f"{each.elbow_deg:.0f} degrees, and its head, upright, at {each.head_upright_deg:.0f}"
        for law, each in newborns.items()
    )
    forward = "; ".join(f"by `{law}` {_forward([each for each in found if each.development == law])}" for law in LAWS)
    return (
        f"In words: {flexed}. Slack sitters slump forward, {forward}. One whose weight is over its seat falls back by "
        "either law, as its pelvis is round."
    )


def _forward(found: Sequence[Rest]) -> str:
    parts = (f"from {lean:g} at {_ages(found, index)}" for index, lean in enumerate(LEANS))
    return ", ".join(parts)


def _ages(found: Sequence[Rest], index: int) -> str:
    ages = [f"{each.age_months:g}" for each in found if each.slumps_deg[index] > 0]
    if len(ages) == len(found):
        return "all ages"
    return f"{', '.join(ages)} months" if ages else "no age"


def _sensitivity(findings: Findings) -> str:
    rows = []
    for name in dict.fromkeys(each.trial for each in findings.sensitivity):
        ages = {each.condition: each.youngest_months for each in findings.sensitivity if each.trial == name}
        usual = _youngest(findings.milestones, "maturing", name)
        rows.append((TRIALS[name].title, *map(_months, (usual, *(ages[condition] for condition in VARIATIONS)))))
    return markdown_table(("trial", "as above", *VARIATIONS), rows)
