"""Passive joints: stiffness, damping, armature, rest angles and ranges, and what strong motors add to them.

By the published law they are MIMo's at every age. By the law `maturing`, inertia, stiffness and damping of a joint are
all proportional to the fifth power of height, so that children of every height swing alike (Lebiedowska & Fisk 1999, 5
to 18 years, S; extrapolated to infants, D). With the volume v of the part that the joint moves and the standing height
l, both relative to 18 months, stiffness, damping and armature are those of 18 months x s,

    s = v l²

and nothing rubs: a relaxed joint has no Coulomb friction to speak of (D). At 18 months, hips, knees, shoulders and
elbows are those of relaxed limbs that swing freely, with the greatest weight moment W and inertia I of what hangs on
them over all postures, the stiffness k = kappa W, armature a, and the damping ratio zeta of the pendulum test,

    c = 2 zeta sqrt((k + W) (I + a))

The neck has MIMo's stiffness, and other joints have MIMo's figures. Angles go from the newborn's to those of 18 months:
q = q_18 + (q_0 - q_18) decay(age). Muscle tone is no spring; see `mimoc.body.strength`.

Limits stop a joint at the ends of its range. A limit is a spring with a damper, at its critical damping with a time
constant tau: a joint that arrives at the speed w goes w tau / e too far, and up to w h more with physics steps of h,
because a limit acts from the first step on that begins beyond it. MIMo's 20 ms let limbs that swing freely, of 25 to 40
rad/s, go 8 to 25 degrees too far. By the law `maturing`, tau is 10 ms, or 2 h for steps longer than 5 ms, the shortest
that MuJoCo admits: a single step then stops a joint. Its limits act from

    m = min(max(0, w h - OVERSHOOT), range / 4),    h = 5 ms

before its end, such that with physics steps of 5 ms a joint no faster than w goes `OVERSHOOT` too far at most, if its
range is not small (D): 2 degrees of limbs, 8 of fingers and toes, and 0 of eyes. A slowly moved joint stops there, too;
so longer steps, which would need 12 degrees of limbs, have no more and overshoot further. What `margin` means to joints
is the same from MuJoCo 3.5 on.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from mimoc.anatomy.anatomy import Anatomy
from mimoc.anatomy.part import REFERENCE_AGE_MONTHS, Development, ReferenceJoint
from mimoc.body.maturation import EYES, FINGERS, FISTS, NECK, Decay, heavier, matured, size_gain
from mimoc.body.origins import AGE_KEY, CONSTANT, LAW, LAW_KEY, LENGTH_KEY, REFERENCE, Origin
from mimoc.body.reference import Reference
from mimoc.body.shapes import Shapes
from mimoc.body.strength import FASTEST_RAD_S, TONE
from mimoc.body.tree import BodyTree, Joint, MaturationFactors, mirror, mirror_turn

PUBLISHED_TAU_S, TAU_S = 0.02, 0.01
IMPEDANCE = (0.98, 0.99, 0.001, 0.5, 1.0)  # MIMo's `solimplimit`.

LIGHT_RAD_S, EYES_RAD_S = 55.0, 13.5
"""Speed w of fingers and toes, which blows give them (D, random commands), and of eyes: torque by damping. Limbs have
that at which motors no longer pull."""
LIGHT_KGM2 = 5e-4  # Largest armature of fingers and toes at 18 months (MIMo).
OVERSHOOT_DEG = 8.0  # Goal of the largest overshoot (D); contacts and other joints add to it.
STEP_S = 0.005  # Physics step h for which joints stop in time.
MAX_MARGIN_SHARE = 0.25  # Largest margin, as a share of the range: half of a small range stays free (D).


def limits_of(development: Development) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Return the attributes in MJCF that all limits of a law of development have in common."""
    tau_s = PUBLISHED_TAU_S if development == "published" else TAU_S
    return ("solreflimit", (tau_s, 1.0)), ("solimplimit", IMPEDANCE)


def limit_margin(figures: ReferenceJoint, group: str, range_deg: tuple[float, float]) -> float:
    """Return how far before both ends of its range a joint's limits act by the law `maturing`, m, in [deg]."""
    low, high = range_deg
    return min(
        max(0.0, math.degrees(_speed_rad_s(figures, group) * STEP_S) - OVERSHOOT_DEG), MAX_MARGIN_SHARE * (high - low)
    )


def margin_origin(joint: str, figures: ReferenceJoint, group: str) -> Origin:
    """Return where the margin of a joint comes from, named with its side; the other arguments are `limit_margin`'s."""
    rule = (
        f"how far before both ends of its range limits act by {LAW}: {_speed_rad_s(figures, group):g} rad/s x "
        f"{1000 * STEP_S:g} ms - {OVERSHOOT_DEG:g} degrees that a joint so fast may still go too far, but no more than "
        f"{MAX_MARGIN_SHARE:g} x the range (D)"
    )
    return Origin(rule, (f"joint.{joint}.range", LAW_KEY))


def _speed_rad_s(figures: ReferenceJoint, group: str) -> float:
    limb_rad_s = LIGHT_RAD_S if figures.armature_kgm2 <= LIGHT_KGM2 else FASTEST_RAD_S
    return EYES_RAD_S if group == "eyes" else limb_rad_s


LIMB, HEAD = 0.13, 0.4
"""Damping ratios zeta of relaxed joints: .07 to .12 (D) of adults' shanks, which swing 8 times (S, recorded pendulum
tests); that of the neck is a guess (D)."""


@dataclass(frozen=True, slots=True)
class Relaxed:
    """A relaxed joint of 18 months, with what hangs on it in the average child of that age."""

    weight_nm: float  # W, the greatest weight moment about the joint (D, from the compiled body).
    inertia_kgm2: float  # I, the greatest inertia about the joint, without armature (likewise).
    stiffness: float | None = None
    """kappa; None for MIMo's stiffness. Chosen such that a shank hangs within 15 degrees of the vertical (D)."""
    rest_deg: float | None = None  # Where its spring is at rest (D, a guess); None as in MIMo.
    damping_ratio: float = LIMB  # zeta.
    armature: float = 1.0  # Factor on MIMo's armature (D).


RELAXED: Mapping[str, Relaxed] = {
    "robot:{side}_hip1": Relaxed(2.21, 0.0504, 0.15, -20.0),
    "robot:{side}_hip2": Relaxed(2.21, 0.0507, 0.7, -15.0),
    "robot:{side}_hip3": Relaxed(0.614, 0.0101, 0.8, 20.0),
    "robot:{side}_knee": Relaxed(0.648, 0.0102, 0.15, -40.0),
    "robot:{side}_shoulder_horizontal": Relaxed(0.748, 0.0136, 0.1, armature=2.0),
    "robot:{side}_shoulder_ad_ab": Relaxed(0.672, 0.0121, 0.1),
    "robot:{side}_shoulder_rotation": Relaxed(0.210, 0.00248, 0.05),
    "robot:{side}_elbow": Relaxed(0.215, 0.0026, 0.15, -30.0),
    "robot:head_swivel": Relaxed(0.832, 0.00837, damping_ratio=HEAD),
    "robot:head_tilt": Relaxed(0.836, 0.00946, damping_ratio=HEAD),
    "robot:head_tilt_side": Relaxed(0.600, 0.00643, damping_ratio=HEAD),
}
"""Joints that swing; the head's W and I are those of the published, lighter head, since all of a neck grows with it."""

EYE_ARMATURE, EYE_DAMPING_PER_S, EYE_STIFFNESS_PER_S2 = 0.1, 20.0, 20.0
"""Factor on MIMo's armature of eyes, and their damping and stiffness by armature (D): infants' saccades are nearly as
fast as adults' (Hainline et al. 1984, S)."""
MIN_ARMATURE_KGM2 = 5e-4
"""Least armature at 18 months but of eyes and of joints that close a hand: MIMo's of a mitten's toes. Two-toed feet,
thumbs and fingers that spread have 1e-4 in MIMo: their motors accelerate them by up to 3,600 rad/s2, and blows throw
them beyond their ends (D)."""
FINGER_ARMATURE, FINGER_DAMPING = 4.0, 3.0
"""Factors on MIMo's figures of joints that close a hand, whose motors are as much stronger at birth (D)."""

NEWBORN_FIST_DEG: Mapping[str, float] = {
    "robot:{side}_fingers": -100.0,
    **{joint: 50.0 if joint.endswith("distal") else 65.0 for joint in FISTS},
}
"""Angles at which newborns' fingers are at rest: fists (Amiel-Tison, Ballard; M); five fingers are bent as far in their
ranges as a mitten's (D)."""


@dataclass(frozen=True, slots=True)
class Limit:
    """One end of a newborn's range of motion."""

    newborn_deg: float
    decay: Decay
    source: str  # Publications, with what is known of them: S read in the source, M from memory, D derived.
    later_deg: float | None = None  # At 18 months; None as in MIMo.

    def at(self, age_months: float, mimos_deg: float) -> float:
        """Return the end at some age."""
        later_deg = mimos_deg if self.later_deg is None else self.later_deg
        return later_deg + (self.newborn_deg - later_deg) * self.decay(age_months)


_HIPS = "Schmale 2003 (S: 40 to 85 out, 25 to 63 in at one year); Coon 1975 (S: out > in); 70 to 90 out at birth (M)"
UPPER_LIMITS: Mapping[str, Limit] = {
    "robot:{side}_hip1": Limit(
        -32.0, Decay(12.0, 1.0), "Coon 1975 (S); Broughton 1993, Haas 1973, Forero 1989, Waugh 1983, Phelps 1985 (M)"
    ),
    "robot:{side}_hip3": Limit(80.0, Decay(12.0, 1.0), _HIPS, 60.0),
    "robot:{side}_knee": Limit(-21.4, Decay(5.5, 1.0), "Broughton 1993 (S)"),
    "robot:{side}_foot1": Limit(59.0, Decay(6.0, 1.0), "Waugh 1983 (M)"),
    "robot:{side}_elbow": Limit(-19.0, Decay(3.0, 1.0), "Shah (S)"),
}
LOWER_LIMITS: Mapping[str, Limit] = {
    "robot:{side}_hip3": Limit(-40.0, Decay(12.0, 1.0), _HIPS, -40.0),
    "robot:{side}_knee": Limit(-150.0, Decay(12.0, 1.0), "heel to buttock (M)", -150.0),
    "robot:{side}_foot1": Limit(-26.0, Decay(6.0, 1.0), "Waugh 1983 (M)"),
}
"""Newborns cannot straighten hips, knees and elbows; they bend their ankles further up, and less far down. Their hips
turn further out than in."""

NOISE = 1e-9  # Relative difference below which two strengths count as equal.


@dataclass(frozen=True, slots=True)
class PassiveFigures:
    """What a joint of 18 months has by the law `maturing`, and why."""

    stiffness_nm_per_rad: float
    damping_nms_per_rad: float
    armature_kgm2: float
    rest_deg: float
    why: Mapping[str, str]  # By attribute in MJCF.


def passive_joints(shapes: Shapes, reference: Reference, growth: MaturationFactors | None) -> dict[str, Joint]:
    """Return the joints of a child by name; without *growth*, by the published law, all are as at 18 months."""
    groups, joints = reference.anatomy.groups, dict[str, Joint]()
    for side, part in reference.anatomy.parts:
        for figures in part.joints:
            left, name = side == "left", figures.name.format(side=side)
            joint = Joint(
                name,
                axis=figures.left_axis if left and figures.left_axis else mirror_turn(figures.axis, left),
                anchor_m=mirror(shapes.built[side].anchors.get(figures.name, (0.0, 0.0, 0.0)), left),
                range_deg=figures.range_deg,
                stiffness_nm_per_rad=figures.stiffness_nm_per_rad,
                damping_nms_per_rad=figures.damping_nms_per_rad,
                frictionloss_nm=figures.frictionloss_nm,
                armature_kgm2=figures.armature_kgm2,
                springref_deg=figures.springref_deg,
            )
            joints[name] = _matured(joint, figures, groups[name], growth) if growth else joint
    return joints


def _matured(joint: Joint, figures: ReferenceJoint, group: str, growth: MaturationFactors) -> Joint:
    age_months = growth.mature_months
    at_18 = figures_at_18(figures, group)
    size = size_gain(joint.name, group, growth)
    low, high = figures.range_deg
    if limit := LOWER_LIMITS.get(figures.name):
        low = limit.at(age_months, low)
    if limit := UPPER_LIMITS.get(figures.name):
        high = limit.at(age_months, high)
    rest_deg = at_18.rest_deg + (NEWBORN_FIST_DEG.get(figures.name, at_18.rest_deg) - at_18.rest_deg) * TONE(age_months)
    return replace(
        joint,
        range_deg=(low, high),
        stiffness_nm_per_rad=at_18.stiffness_nm_per_rad * size,
        damping_nms_per_rad=at_18.damping_nms_per_rad * size,
        frictionloss_nm=0.0,
        armature_kgm2=at_18.armature_kgm2 * size,
        springref_deg=min(max(rest_deg, low), high),
        margin_deg=limit_margin(figures, group, (low, high)),
    )


def figures_at_18(figures: ReferenceJoint, group: str) -> PassiveFigures:
    """Return stiffness, damping, armature and rest angle of a joint of 18 months by the law `maturing`."""
    stiffness, damping = figures.stiffness_nm_per_rad, figures.damping_nms_per_rad
    armature, rest_deg = figures.armature_kgm2, figures.springref_deg
    why = {
        "stiffness": f"{stiffness:g} ({REFERENCE})",
        "damping": f"{damping:g} ({REFERENCE})",
        "armature": f"{armature:g} ({REFERENCE})",
    }
    if group == EYES:
        armature *= EYE_ARMATURE
        why["armature"] += f" x {EYE_ARMATURE:g} (saccades as fast as adults': Hainline et al. 1984, S; D)"
        damping, stiffness = EYE_DAMPING_PER_S * armature, EYE_STIFFNESS_PER_S2 * armature
        why["damping"] = f"{EYE_DAMPING_PER_S:g} / s x armature of 18 months (D)"
        why["stiffness"] = f"{EYE_STIFFNESS_PER_S2:g} / s2 x armature of 18 months (D)"
    elif figures.name in FINGERS:
        armature, damping = FINGER_ARMATURE * armature, FINGER_DAMPING * damping
        why["armature"] += f" x {FINGER_ARMATURE:g} for newborns' stronger fingers (D)"
        why["damping"] += f" x {FINGER_DAMPING:g} for newborns' stronger fingers (D)"
    elif armature < MIN_ARMATURE_KGM2:
        armature = MIN_ARMATURE_KGM2
        why["armature"] = f"{MIN_ARMATURE_KGM2:g}, as of toes that move together (D)"
    elif relaxed := RELAXED.get(figures.name):
        armature *= relaxed.armature
        if relaxed.armature != 1:
            why["armature"] += f" x {relaxed.armature:g} for its stronger motor (D)"
        if relaxed.stiffness is not None:
            stiffness = relaxed.stiffness * relaxed.weight_nm
            why["stiffness"] = (
                f"{relaxed.stiffness:g} x weight moment {relaxed.weight_nm:g} N m of 18 months (such that a relaxed "
                "shank hangs within 15 degrees of the vertical; D)"
            )
        if relaxed.rest_deg is not None:
            rest_deg = relaxed.rest_deg
        inertia, weight = relaxed.inertia_kgm2 + armature, relaxed.weight_nm + stiffness
        damping = 2 * relaxed.damping_ratio * math.sqrt(weight * inertia)
        why["damping"] = (
            f"2 x {relaxed.damping_ratio:g} x sqrt({weight:.4g} N m x {inertia:.4g} kg m2): damping ratio of the "
            + ("neck, a guess; D" if group == NECK else "pendulum test, .07 to .12 as recorded in adults; D")
            + ", with stiffness, weight moment, inertia and armature of 18 months"
        )
    return PassiveFigures(stiffness, damping, armature, rest_deg, why)


def match_damping(tree: BodyTree, average: BodyTree, anatomy: Anatomy) -> BodyTree:
    """Return a body whose damping and armature are scaled with any strength above average.

    If a motor is stronger than that of the average child of the same age, because a spec makes a part or a child larger
    or stronger, its joint's damping and armature grow with it, as far as needed for neither the speed at which damping
    balances the motor's torque nor the acceleration of the armature under this torque to exceed the average child's, or
    MIMo's by the published law if they are more. With the torque T of the motor and T_a of the average child's, by the
    published law at least MIMo's T_18, a joint's constant c is multiplied by max(1, T c_a / (T_a c)), where c_a is that
    of the average child. By the law `maturing`, larger children are stronger and have larger joints anyway.
    """
    joints = tree.joints
    usual_joints = average.joints
    matched = dict[str, Joint]()
    for motor, usual, (_, figures) in zip(tree.motors, average.motors, anatomy.motors, strict=True):
        joint = joints[motor.joint]
        usual_joint = usual_joints[motor.joint]
        usual_nm = usual.gear_nm if tree.growth else max(usual.gear_nm, figures.gear_nm)
        damping, armature = (
            max(1.0, motor.gear_nm / usual_nm * (before / now if now else 1.0))
            for now, before in (
                (joint.damping_nms_per_rad, usual_joint.damping_nms_per_rad),
                (joint.armature_kgm2, usual_joint.armature_kgm2),
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
"""Attributes in MJCF of every joint that are numbers of the body; some have a `margin`, too."""


def joint_origins(
    joint: Joint, figures: ReferenceJoint, group: str, motor: str | None, tree: BodyTree
) -> dict[str, Origin]:
    """Return where a joint's attributes in MJCF come from, by attribute; *group* is what its strength matures with."""
    published = Origin(f"{REFERENCE}; the same at every age by the law `published`", (LAW_KEY,))
    origins = dict.fromkeys(CONSTANTS, Origin(CONSTANT) if tree.growth else published)
    usual = {"damping": figures.damping_nms_per_rad, "armature": figures.armature_kgm2}
    if tree.growth:
        at_18 = figures_at_18(figures, group)
        size = size_gain(joint.name, group, tree.growth)
        origins |= _maturing_origins(figures, joint.name, group, tree.growth)
        origins["margin"] = margin_origin(joint.name, figures, group)
        usual = {"damping": at_18.damping_nms_per_rad * size, "armature": at_18.armature_kgm2 * size}
    for name, value in (("damping", joint.damping_nms_per_rad), ("armature", joint.armature_kgm2)):
        if not math.isclose(value, usual[name]):
            start = origins[name].rule if tree.growth else f"{usual[name]:g} ({REFERENCE})"
            rule = f"{start} x {value / usual[name]:.6g}, by which its motor is stronger than the average child's"
            origins[name] = Origin(rule, (*origins[name].sources, f"actuator.{motor}.gear"))
    for attribute, text, key in joint.changes:
        origins[attribute] = origins[attribute].times(text, key)
    return origins


def _maturing_origins(figures: ReferenceJoint, joint: str, group: str, growth: MaturationFactors) -> dict[str, Origin]:
    grown = (
        f" x {growth.relative_volumes[joint]:.6g} x {growth.relative_length:.6g} ^ 2: volume of the part that the "
        f"joint moves, and standing height, relative to 18 months, by {LAW} (Lebiedowska & Fisk 1999, S; D for infants)"
    )
    origins = {
        name: Origin(why + grown + heavier(group, growth), (LENGTH_KEY, AGE_KEY, LAW_KEY))
        for name, why in figures_at_18(figures, group).why.items()
    }
    rubbing = f"none by {LAW}: a relaxed joint has no Coulomb friction to speak of, and with MIMo's no limb swings (D)"
    angles = {name: matured(origin, growth) for name, origin in _angle_origins(figures)}
    return {**origins, "frictionloss": Origin(rubbing, (LAW_KEY,)), **angles}


def _angle_origins(figures: ReferenceJoint) -> Iterator[tuple[str, Origin]]:
    newborn_deg = NEWBORN_FIST_DEG.get(figures.name)
    relaxed = RELAXED.get(figures.name)
    if newborn_deg is not None:
        rest = f"by {LAW}, from {newborn_deg:g} degrees at birth (fists: Amiel-Tison, Ballard; M)"
        text = f"{rest} to {figures.springref_deg:g} at 18 months ({REFERENCE}), within the range"
        yield "springref", Origin(text, (AGE_KEY, LAW_KEY))
    elif relaxed and relaxed.rest_deg is not None:
        text = f"by {LAW}, {relaxed.rest_deg:g} degrees at every age (a guess; D), within the range"
        yield "springref", Origin(text, (AGE_KEY, LAW_KEY))
    ends = ("lower", LOWER_LIMITS, figures.range_deg[0]), ("upper", UPPER_LIMITS, figures.range_deg[1])
    changing = [
        f"{end} end from {limit.newborn_deg:g} degrees at birth to {limit.at(REFERENCE_AGE_MONTHS, at_deg):g} at 18 "
        f"months ({limit.source}{f'; {REFERENCE}' if limit.later_deg is None else ''})"
        for end, limits, at_deg in ends
        if (limit := limits.get(figures.name))
    ]
    if changing:
        yield "range", Origin(f"by {LAW}, {', '.join(changing)}", (AGE_KEY, LAW_KEY))
