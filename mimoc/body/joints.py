"""Passive joints: stiffness, friction, damping, armature, rest angles and ranges, and what strong motors add to them.

By the published law they are MIMo's at every age. By the law `maturing`, a passive torque keeps its proportion to
gravity, which grows by volume x length; with constants, a newborn's neck spring alone would hold up its head (D: no
stiffness of infants' joints was measured). With v the volume of the part that the joint moves and l the standing
height, both relative to 18 months, a constant c of MIMo's becomes

    c v l^p,    p = 1 for stiffness and friction, 1.5 for damping, 2 for armature

and angles go from the newborn's to MIMo's: q = q_18 + (q_0 - q_18) decay(age).
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from mimoc.body.anatomy import Anatomy
from mimoc.body.dimensions import mirror, mirror_turn
from mimoc.body.maturation import NECK, Decay, heavier
from mimoc.body.origins import AGE_KEY, CONSTANT, LAW, LAW_KEY, LENGTH_KEY, REFERENCE, Origin
from mimoc.body.part import REFERENCE_AGE_MONTHS, ReferenceJoint
from mimoc.body.reference import Reference
from mimoc.body.shapes import Shapes
from mimoc.body.tree import BodyTree, Joint, MaturationFactors

POWERS: Mapping[str, float] = {"stiffness": 1.0, "frictionloss": 1.0, "damping": 1.5, "armature": 2.0}
"""Powers of the standing height that a joint's constants grow by, besides the volume of the part (D)."""

TONE = Decay(2.5, 1.5)
"""Flexor tone, shed over 2 to 4 months and gone by 6 (Amiel-Tison; Ballard 1991; M)."""

_FIST = {
    f"robot:{{side}}_{finger}_{joint}"
    for finger in ("ff", "mf", "rf", "lf")
    for joint in ("knuckle", "middle", "distal")
}
"""Joints that close five fingers to a fist."""

EXTRA_STIFFNESS: Mapping[str, float] = {
    "robot:{side}_hip1": 0.5,
    "robot:{side}_knee": 0.5,
    "robot:{side}_fingers": 0.5,
    "robot:{side}_elbow": 1.0,
    **dict.fromkeys(sorted(_FIST), 0.5),
}
"""How much stiffer newborns' joints are by their tone, relative to the law (D; arm recoil: Ballard 1991)."""

NEWBORN_REST_DEG: Mapping[str, float] = {
    "robot:{side}_hip1": -65.0,
    "robot:{side}_hip2": -30.0,
    "robot:{side}_knee": -90.0,
    "robot:{side}_elbow": -100.0,
    "robot:{side}_fingers": -100.0,
    "robot:{side}_foot1": 20.0,
    **{joint: 50.0 if joint.endswith("distal") else 65.0 for joint in sorted(_FIST)},
}
"""Angles at which newborns' springs are at rest: hips bent by 60 to 90 degrees, knees by 90, elbows by 90 to 110, fists
closed, ankles up (Amiel-Tison, Ballard; M); five fingers are bent as far in their ranges as a mitten's (D)."""


@dataclass(frozen=True, slots=True)
class Limit:
    """One end of a newborn's range of motion."""

    newborn_deg: float
    decay: Decay
    source: str
    """Publications, with what is known of them: S read in the source, M from memory, D derived."""


UPPER_LIMITS: Mapping[str, Limit] = {
    "robot:{side}_hip1": Limit(
        -32.0, Decay(12.0, 1.0), "Coon 1975 (S); Broughton 1993, Haas 1973, Forero 1989, Waugh 1983, Phelps 1985 (M)"
    ),
    "robot:{side}_knee": Limit(-21.4, Decay(5.5, 1.0), "Broughton 1993 (S)"),
    "robot:{side}_foot1": Limit(59.0, Decay(6.0, 1.0), "Waugh 1983 (M)"),
    "robot:{side}_elbow": Limit(-19.0, Decay(3.0, 1.0), "Shah (S)"),
}
LOWER_LIMITS: Mapping[str, Limit] = {"robot:{side}_foot1": Limit(-26.0, Decay(6.0, 1.0), "Waugh 1983 (M)")}
"""Newborns cannot straighten hips, knees and elbows; they bend their ankles further up, and less far down."""

NOISE = 1e-9
"""Relative difference below which two strengths count as equal."""


def passive_joints(shapes: Shapes, reference: Reference, growth: MaturationFactors | None) -> dict[str, Joint]:
    """Return the joints of a child by name; without *growth*, by the published law, all are as at 18 months."""
    groups, joints = reference.anatomy.groups, dict[str, Joint]()
    age_months = reference.age_months if growth else REFERENCE_AGE_MONTHS
    tone = TONE(age_months)
    for side, part in reference.anatomy.parts:
        for figures in part.joints:
            left, name, rest_deg = side == "left", figures.name.format(side=side), figures.springref_deg
            scales = _scales(name, groups[name], growth)
            low, high = figures.range_deg
            low = _limit(LOWER_LIMITS.get(figures.name), low, age_months)
            high = _limit(UPPER_LIMITS.get(figures.name), high, age_months)
            rest_deg += (NEWBORN_REST_DEG.get(figures.name, rest_deg) - rest_deg) * tone
            stiffness_nm_per_rad = figures.stiffness_nm_per_rad * scales["stiffness"]
            joints[name] = Joint(
                name,
                axis=figures.left_axis if left and figures.left_axis else mirror_turn(figures.axis, left),
                anchor_m=mirror(shapes.built[side].anchors.get(figures.name, (0.0, 0.0, 0.0)), left),
                range_deg=(low, high),
                stiffness_nm_per_rad=stiffness_nm_per_rad * _stiffening(figures.name, tone),
                damping_nms_per_rad=figures.damping_nms_per_rad * scales["damping"],
                frictionloss_nm=figures.frictionloss_nm * scales["frictionloss"],
                armature_kgm2=figures.armature_kgm2 * scales["armature"],
                springref_deg=min(max(rest_deg, low), high),
            )
    return joints


def _scales(joint: str, group: str, growth: MaturationFactors | None) -> dict[str, float]:
    """Return the factors v l^p on a joint's constants, by attribute, for the neck also x what its head is heavier."""
    if growth is None:
        return dict.fromkeys(POWERS, 1.0)
    size = growth.relative_volumes[joint] * (growth.head_gain if group == NECK else 1.0)
    return {attribute: size * growth.relative_length**power for attribute, power in POWERS.items()}


def _stiffening(joint: str, tone: float) -> float:
    """Return how much stiffer a joint, named with `{side}`, is by some flexor tone (1 at birth)."""
    return 1 + EXTRA_STIFFNESS.get(joint, 0.0) * tone


def _limit(limit: Limit | None, at_18_deg: float, age_months: float) -> float:
    return at_18_deg + (limit.newborn_deg - at_18_deg) * limit.decay(age_months) if limit else at_18_deg


def match_damping(tree: BodyTree, average: BodyTree, anatomy: Anatomy) -> BodyTree:
    """Return a body whose damping and armature are scaled with any strength above average.

    If a motor is stronger than that of the average child of the same age, because a spec makes a part or a child larger
    or stronger, its joint's damping and armature grow with it, as far as needed for neither the speed at which damping
    balances the motor's torque nor the acceleration of the armature under this torque to exceed MIMo's, or those of
    the average child if they are more. With the torques T of the motor, T_a of the average child's and T_18 of MIMo's,
    a joint's constant is multiplied by max(1, T / max(T_a, T_18 c / c_18)), where c is that of the average child and
    c_18 that of MIMo.
    """
    at_18 = {joint.name.format(side=side): joint for side, part in anatomy.parts for joint in part.joints}
    joints, usual_joints, matched = tree.joints, average.joints, dict[str, Joint]()
    for motor, usual, (_, figures) in zip(tree.motors, average.motors, anatomy.motors, strict=True):
        joint, usual_joint, reference = joints[motor.joint], usual_joints[motor.joint], at_18[motor.joint]
        damping, armature = (
            max(1.0, motor.gear_nm / max(usual.gear_nm, figures.gear_nm * now / then))
            for now, then in (
                (usual_joint.damping_nms_per_rad, reference.damping_nms_per_rad),
                (usual_joint.armature_kgm2, reference.armature_kgm2),
            )
        )
        if max(damping, armature) > 1 + NOISE:
            matched[joint.name] = replace(
                joint,
                damping_nms_per_rad=damping * joint.damping_nms_per_rad,
                armature_kgm2=armature * joint.armature_kgm2,
            )
    bodies = (
        replace(body, joints=tuple(matched.get(joint.name, joint) for joint in body.joints)) for body in tree.bodies
    )
    return replace(tree, bodies=tuple(bodies)) if matched else tree


CONSTANTS: tuple[str, ...] = ("range", "stiffness", "damping", "frictionloss", "armature", "springref")
"""A joint's attributes in MJCF that are numbers of the body."""


def joint_origins(
    joint: Joint, figures: ReferenceJoint, group: str, motor: str | None, tree: BodyTree
) -> dict[str, Origin]:
    """Return where a joint's attributes in MJCF come from, by attribute; *group* is what its strength matures with."""
    published = Origin(f"{REFERENCE}; the same at every age by the law `published`", (LAW_KEY,))
    origins = dict.fromkeys(CONSTANTS, Origin(CONSTANT) if tree.growth else published)
    if tree.growth:
        origins |= _maturing_origins(figures, joint.name, group, tree.age_months, tree.growth)
    scales = _scales(joint.name, group, tree.growth)
    for name, value, at_18 in (
        ("damping", joint.damping_nms_per_rad, figures.damping_nms_per_rad),
        ("armature", joint.armature_kgm2, figures.armature_kgm2),
    ):
        usual = at_18 * scales[name]
        if not math.isclose(value, usual):
            start = origins[name].rule if tree.growth else f"{usual:g} ({REFERENCE})"
            rule = f"{start} x {value / usual:.6g}, by which its motor is stronger than the average child's"
            origins[name] = Origin(rule, (*origins[name].sources, f"actuator.{motor}.gear"))
    return origins


def _maturing_origins(
    figures: ReferenceJoint, joint: str, group: str, age_months: float, growth: MaturationFactors
) -> dict[str, Origin]:
    origins = dict[str, Origin]()
    for name, at_18 in (
        ("stiffness", figures.stiffness_nm_per_rad),
        ("frictionloss", figures.frictionloss_nm),
        ("damping", figures.damping_nms_per_rad),
        ("armature", figures.armature_kgm2),
    ):
        text = (
            f"{at_18:g} ({REFERENCE}) x {growth.relative_volumes[joint]:.6g} x {growth.relative_length:.6g} ^ "
            f"{POWERS[name]:g}: volume of the part that the strength here follows, and standing height, relative to "
            f"18 months, by {LAW} (a passive torque keeps its proportion to gravity; D)"
        )
        origins[name] = Origin(text + heavier(group, growth), (LENGTH_KEY, AGE_KEY, LAW_KEY))
    factor = _stiffening(figures.name, TONE(age_months))
    if factor > 1:
        tone = f" x {factor:.6g} for the flexor tone of this age (D; arm recoil: Ballard 1991, S)"
        origins["stiffness"] = origins["stiffness"].times(tone)
    return {**origins, **dict(_angle_origins(figures))}


def _angle_origins(figures: ReferenceJoint) -> Iterator[tuple[str, Origin]]:
    """Yield the origins of the angles that change with age."""
    newborn_deg = NEWBORN_REST_DEG.get(figures.name)
    if newborn_deg is not None:
        rest = f"by {LAW}, from {newborn_deg:g} degrees at birth (flexor tone: Amiel-Tison, Ballard; M)"
        text = f"{rest} to {figures.springref_deg:g} at 18 months ({REFERENCE}), within the range"
        yield "springref", Origin(text, (AGE_KEY, LAW_KEY))
    ends = ("lower", LOWER_LIMITS, figures.range_deg[0]), ("upper", UPPER_LIMITS, figures.range_deg[1])
    changing = [
        f"{end} end from {limit.newborn_deg:g} degrees at birth ({limit.source}) to {at_deg:g}"
        for end, limits, at_deg in ends
        if (limit := limits.get(figures.name))
    ]
    if changing:
        yield "range", Origin(f"by {LAW}, {', '.join(changing)} at 18 months ({REFERENCE})", (AGE_KEY, LAW_KEY))
