"""How the law `maturing` makes each number, for people, with the certainty of its source.

S means read in the source, M known from memory, D derived for mimoc.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from mimoc.body.figures import JointFigures
from mimoc.body.maturing.joints import LOWER_LIMITS, NEWBORN_REST_DEG, POWERS, TONE, UPPER_LIMITS
from mimoc.body.maturing.mature import stiffening, strengths
from mimoc.body.maturing.strength import NECK
from mimoc.body.tree import Growth

REFERENCE = "MIMo's reference body, 18 months"
LENGTH_KEY, AGE_KEY = "measurements.crown_sole_length_cm", "spec.age_months"


@dataclass(frozen=True, slots=True)
class Rule:
    """Origin of a number."""

    text: str
    """How it is computed, with the publication and how certain it is."""
    sources: tuple[str, ...]
    """Keys of the numbers that it is computed from (`mimoc explain`)."""


def gear_rule(motor: str, group: str, age_months: float, growth: Growth) -> Rule:
    """Return what the law adds to the volume that a motor's gear follows."""
    strength, _ = strengths(motor, group, age_months)
    text = (
        f" x {growth.relative_length:.6g}, the standing height relative to 18 months, x {strength:.6g}, the share of "
        f"its strength at 18 months that the {group} has at this age (fitted to the ages of milestones; D)"
    )
    return Rule(text + _heavier(group, growth), (LENGTH_KEY, AGE_KEY))


def force_range_rule(motor: str, group: str, age_months: float) -> Rule | None:
    """Return the rule of a motor's force range, if the two directions mature differently."""
    negative, positive = strengths(motor, group, age_months)
    if negative == positive:
        return None
    ratio = f"{positive / negative:.6g}, the strength of its front by that of its back at this age (fitted; D)"
    return Rule(f"{REFERENCE}, towards positive angles x {ratio}", (AGE_KEY,))


def joint_rules(figures: JointFigures, group: str, age_months: float, growth: Growth) -> dict[str, Rule]:
    """Return the rules of a joint's attributes in MJCF.

    Args:
        figures: The joint at 18 months.
        group: The group that it matures with.
        age_months: Age of the infant.
        growth: Its size.
    """
    at_18 = {
        "stiffness": figures.stiffness_nm_per_rad,
        "frictionloss": figures.frictionloss_nm,
        "damping": figures.damping_nms_per_rad,
        "armature": figures.armature_kgm2,
    }
    return {
        **{name: _passive_rule(name, value, figures.name, group, age_months, growth) for name, value in at_18.items()},
        **dict(_angle_rules(figures)),
    }


def _passive_rule(attribute: str, value: float, joint: str, group: str, age_months: float, growth: Growth) -> Rule:
    text = (
        f"{value:g} ({REFERENCE}) x volume of what its motor's strength follows x standing height "
        f"({growth.relative_length:.6g}) ^ {POWERS[attribute]:g}, both relative to 18 months (D)"
    )
    stiffer = stiffening(joint, TONE(age_months))
    if attribute == "stiffness" and stiffer > 1:
        text += f" x {stiffer:.6g} for the flexor tone of this age (D; Ballard 1991)"
    return Rule(text + _heavier(group, growth), (LENGTH_KEY, AGE_KEY))


def _heavier(group: str, growth: Growth) -> str:
    gain = f" x {growth.head_gain:.6g}, by which head and neck are heavier than by the published law (D)"
    return gain if group == NECK else ""


def _angle_rules(figures: JointFigures) -> Iterator[tuple[str, Rule]]:
    """Yield the rules of the angles that change with age."""
    newborn_deg = NEWBORN_REST_DEG.get(figures.name)
    if newborn_deg is not None:
        rest = f"from {newborn_deg:g} degrees at birth (flexor tone: Amiel-Tison, Ballard; M)"
        yield "springref", Rule(f"{rest} to {figures.springref_deg:g} ({REFERENCE}), within the range", (AGE_KEY,))
    ends = ("lower", LOWER_LIMITS, figures.range_deg[0]), ("upper", UPPER_LIMITS, figures.range_deg[1])
    changing = [
        f"{end} end from {limit.newborn_deg:g} at birth ({limit.source}) to {at_deg:g} degrees"
        for end, limits, at_deg in ends
        if (limit := limits.get(figures.name))
    ]
    if changing:
        yield "range", Rule(f"{', '.join(changing)} ({REFERENCE})", (AGE_KEY,))
