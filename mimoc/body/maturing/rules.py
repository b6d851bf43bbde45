"""How the law `maturing` makes each number, for people, with the certainty of its source.

S means read in the source, M known from memory, D derived for mimoc.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from mimoc.body.figures import JointFigures
from mimoc.body.maturing.joints import LOWER_LIMITS, NEWBORN_REST_DEG, POWERS, TONE, UPPER_LIMITS
from mimoc.body.maturing.mature import stiffening, strengths
from mimoc.body.maturing.strength import FORWARDS, NECK, STRENGTH
from mimoc.body.tree import Growth

REFERENCE = "MIMo's reference body, 18 months"
LENGTH_KEY, AGE_KEY, LAW_KEY = "measurements.crown_sole_length_cm", "spec.age_months", "spec.development"
LAW = "the law `maturing`"


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
        f"its strength at 18 months that the {group} has at this age by {LAW} ({_row(group)})"
    )
    return Rule(text + _heavier(group, growth), (LENGTH_KEY, AGE_KEY, LAW_KEY))


def _row(group: str) -> str:
    """Return the row of a group in the table of strengths, with its source."""
    curve = STRENGTH[group]
    decay = f"decay of {curve.decay.tau_months:g} months and power {curve.decay.power:g}"
    return f"row `{group}`: {curve.newborn:g} at birth, {decay}; {_source(group)}"


def _source(group: str) -> str:
    return {"hand": "a guess; D", "eyes": "the same at every age; D"}.get(group, "fitted to the ages of milestones; D")


def force_range_rule(motor: str, group: str, age_months: float) -> Rule | None:
    """Return the rule of a motor's force range, if the two directions mature differently."""
    if motor not in FORWARDS:
        return None
    front, (negative, positive) = FORWARDS[motor], strengths(motor, group, age_months)
    ratio = f"{positive / negative:.6g}, the strength of its front by that of its back at this age by {LAW}"
    text = f"{REFERENCE}, towards positive angles x {ratio} ({_row(front)}; {_row(group)})"
    return Rule(text, (AGE_KEY, LAW_KEY))


def joint_rules(figures: JointFigures, joint: str, group: str, age_months: float, growth: Growth) -> dict[str, Rule]:
    """Return the rules of a joint's attributes in MJCF.

    Args:
        figures: The joint at 18 months.
        joint: Its name, with its side.
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
    passive = {name: _passive_rule(name, value, joint, group, growth) for name, value in at_18.items()}
    stiffness = _stiffer(passive["stiffness"], figures.name, age_months)
    return {**passive, "stiffness": stiffness, **dict(_angle_rules(figures))}


def _passive_rule(attribute: str, value: float, joint: str, group: str, growth: Growth) -> Rule:
    text = (
        f"{value:g} ({REFERENCE}) x {growth.relative_volumes[joint]:.6g} x {growth.relative_length:.6g} ^ "
        f"{POWERS[attribute]:g}: volume of the part that the strength here follows, and standing height, relative to "
        f"18 months, by {LAW} (a passive torque keeps its proportion to gravity; D)"
    )
    return Rule(text + _heavier(group, growth), (LENGTH_KEY, AGE_KEY, LAW_KEY))


def _stiffer(rule: Rule, joint: str, age_months: float) -> Rule:
    """Return the rule of a stiffness with what flexor tone adds to it; *joint* is named with `{side}`."""
    factor = stiffening(joint, TONE(age_months))
    tone = f" x {factor:.6g} for the flexor tone of this age (D; arm recoil: Ballard 1991, S)"
    return replace(rule, text=rule.text + tone) if factor > 1 else rule


def _heavier(group: str, growth: Growth) -> str:
    gain = f" x {growth.head_gain:.6g}, by which head and neck are heavier than by the published law (D)"
    return gain if group == NECK else ""


def _angle_rules(figures: JointFigures) -> Iterator[tuple[str, Rule]]:
    """Yield the rules of the angles that change with age."""
    newborn_deg = NEWBORN_REST_DEG.get(figures.name)
    if newborn_deg is not None:
        rest = f"by {LAW}, from {newborn_deg:g} degrees at birth (flexor tone: Amiel-Tison, Ballard; M)"
        text = f"{rest} to {figures.springref_deg:g} at 18 months ({REFERENCE}), within the range"
        yield "springref", Rule(text, (AGE_KEY, LAW_KEY))
    ends = ("lower", LOWER_LIMITS, figures.range_deg[0]), ("upper", UPPER_LIMITS, figures.range_deg[1])
    changing = [
        f"{end} end from {limit.newborn_deg:g} degrees at birth ({limit.source}) to {at_deg:g}"
        for end, limits, at_deg in ends
        if (limit := limits.get(figures.name))
    ]
    if changing:
        yield "range", Rule(f"by {LAW}, {', '.join(changing)} at 18 months ({REFERENCE})", (AGE_KEY, LAW_KEY))
