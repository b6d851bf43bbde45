"""Strength and muscle tone: the torque of each motor by age and size, and what a spec asks for on top of it.

A motor's torque at full command is

    T = T_18 v l r f

with MIMo's torque T_18 at 18 months, the volume v of the part that it moves and the standing height l, both relative to
18 months, and the share r of its muscle group's strength that an infant of that age has; f is 1 but for the shoulder's
horizontal flexion, the middle joints of fingers and newborns' fingers, and for individuals, of whose volume only the
lean part is strong and whose age counts times their rate of maturation (`mimoc.body.maturation`). The load of its
joint grows by v l, so r and the lean share decide whether an infant can hold its own weight. Of the eyes, T = T_18 v
l², in proportion to their inertia. By the published law, T = T_18 v.

No dynamometry of infants exists. Four numbers were fitted (D), each to one fact: `NEWBORN_SHARE` to the age at which
prone infants lift their heads, `AXIAL_MONTHS` to that at which they sit, `LIMB_MONTHS` to that at which they stand (WHO
Multicentre Growth Reference Study Group 2006; Denver II, Frankenburg et al. 1992), and `NEWBORN_ARM_SHARE` to supine
newborns whose hands are above their shoulders. The ages of all other milestones are predicted. The three groups and the
power were chosen with the least strengths that the trials need in view. Strength of hands is a guess (D).

Tone is what a quiet infant's muscles do without a command. It is a drive and no spring: it acts within the limits of a
motor's strength, grows with arousal, and is gone when an infant is slack. Of a quiet infant, its torque is

    tau = -k (q - q_0),    k = kappa W s M(age)

with the greatest weight moment W of what hangs on the joint at 18 months, the growth s of passive joints (see
`mimoc.body.joints`), and the newborn share M, 1 at birth. The angles q_0 lie beyond the posture that tone holds against
gravity, since a flexor does not resist flexion.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mimoc.anatomy.part import ReferenceMotor
from mimoc.anatomy.published_figures import as_published
from mimoc.body.maturation import EYES, FINGERS, FISTS, HAND, NECK, Decay, RelativeVolumes, heavier, matured, size_gain
from mimoc.body.origins import AGE_KEY, CONSTANT, LAW, LAW_KEY, LENGTH_KEY, REFERENCE, Origin
from mimoc.body.reference import Reference
from mimoc.body.tree import BodyTree, MaturationFactors, Motor, Tone
from mimoc.schema.names import PAIRED_GROUPS

TONE = Decay(2.5, 1.5)  # Flexor tone, shed over 2 to 4 months and gone by 6 (Amiel-Tison; Ballard 1991; M).


@dataclass(frozen=True, slots=True)
class NewbornTone:
    """Tone at birth, for a body of the size of 18 months."""

    stiffness_nm_per_rad: float  # kappa W (D).
    angle_deg: float  # q_0 (D).


_FINGERS = {"ff": 0.006, "mf": 0.012, "rf": 0.008, "lf": 0.002}
"""k of the knuckles, by finger: by a radian, a tenth of their strength at 18 months, or 3 % of a newborn's (D). A hand
that is straightened is a fist again within 3 s; by half of MIMo's stiffness, it would take half a minute."""
_JOINTS = {"knuckle": (1.0, 65.0), "middle": (0.6, 65.0), "distal": (0.25, 50.0)}
"""k by that of the knuckle, as strength is, and q_0."""


def _fist(joint: str) -> NewbornTone:
    _, finger, place = joint.rsplit("_", 2)
    share, angle_deg = _JOINTS[place]
    return NewbornTone(share * _FINGERS[finger], angle_deg)


NEWBORN_TONE: Mapping[str, NewbornTone] = {
    "robot:{side}_hip1": NewbornTone(0.38 * 2.21, -130.0),
    "robot:{side}_hip2": NewbornTone(0.95 * 2.21, -30.0),
    "robot:{side}_hip3": NewbornTone(1.0 * 0.614, 40.0),
    "robot:{side}_knee": NewbornTone(2.5 * 0.648, -88.0),
    "robot:{side}_elbow": NewbornTone(2.5 * 0.215, -100.0),
    "robot:{side}_foot1": NewbornTone(0.5 * 1.29, 20.0),
    "robot:{side}_fingers": NewbornTone(0.5 * 0.017, -100.0),
    **{joint: _fist(joint) for joint in FISTS},
}
"""Chosen such that newborns rest with hips bent by 55 degrees, knees by 90 and elbows by 90, and kick by 50 degrees
with less than .8 of their strength (posture: Amiel-Tison, Ballard, M; k, q_0: D). Of ankles and mittens, k is half of
MIMo's stiffness of their joints."""

SOURCE = "posture of newborns: Amiel-Tison, Ballard, M; fitted to it, D"


def tone_of(joint: str, size: float, age_months: float) -> Tone | None:
    """Return the tone of a joint, named with `{side}`, of passive growth *size*; None if it has none yet."""
    newborn, share = NEWBORN_TONE.get(joint), TONE(age_months)
    if newborn is None or not share:
        return None
    return Tone(newborn.stiffness_nm_per_rad * size * share, newborn.angle_deg)


def tone_origin(motor: Motor) -> Origin:
    """Return where the muscle tone of a motor comes from."""
    if motor.tone is None:
        return Origin("no muscle tone at this joint and age", (AGE_KEY, LAW_KEY))
    rule = (
        f"muscle tone of a quiet infant by {LAW}, {motor.tone.stiffness_nm_per_rad:.6g} N m/rad towards "
        f"{motor.tone.angle_deg:g} degrees, within the strength of the motor ({SOURCE}; lost over 2 to 4 months, M)"
    )
    origin = Origin(rule, (LENGTH_KEY, AGE_KEY, LAW_KEY, "spec.actuation.arousal"))
    for key, factor in motor.tone.factors:
        origin = origin.times(f", of which {factor:.6g} is counted in ({key})", key)
    return origin


STRENGTH_KEY = "spec.actuation.strength"
STRENGTH_AGE_KEY = "spec.actuation.strength_age_months"

NEWBORN_SHARE, NEWBORN_ARM_SHARE = 0.24, 0.12
"""Strength at birth relative to 18 months, beyond what size explains: fitted (D)."""
AXIAL_MONTHS, LIMB_MONTHS, POWER = 6.3, 26.0, 2.0
"""Time constants of neck and trunk, and of arms and legs: fitted (D); and the power of both, chosen (D)."""


@dataclass(frozen=True, slots=True)
class StrengthCurve:
    """The relative strength of a group of muscles by age: r = 1 - (1 - newborn) decay(age)."""

    newborn: float
    decay: Decay
    source: str

    def __call__(self, age_months: float) -> float:
        """Return the strength relative to that at 18 months, beyond what size explains."""
        return 1 - (1 - self.newborn) * self.decay(age_months)


AXIAL = StrengthCurve(
    NEWBORN_SHARE, Decay(AXIAL_MONTHS, POWER), "fitted to the ages of lifting the head while prone and of sitting; D"
)
LEGS = StrengthCurve(
    NEWBORN_SHARE, Decay(LIMB_MONTHS, POWER), "fitted to the ages of lifting the head while prone and of standing; D"
)
ARMS = StrengthCurve(
    NEWBORN_ARM_SHARE,
    Decay(LIMB_MONTHS, POWER),
    "fitted to supine newborns that lift a hand above the shoulder, and to the age of standing; D",
)
STRENGTH: Mapping[str, StrengthCurve] = {
    "neck": AXIAL,
    "trunk": AXIAL,
    "arm": ARMS,
    HAND: StrengthCurve(0.40, Decay(10.0, 1.5), "a guess; D"),
    "hip": LEGS,
    "knee": LEGS,
    "ankle": LEGS,
    EYES: StrengthCurve(1.0, Decay(1.0, 1.0), "the same at every age; D"),
}
"""By group of muscles that mature together (`Part.matures_with`)."""

HORIZONTAL_FLEXION = 3.0
"""Factor on MIMo's torque of the shoulder's horizontal flexion, 1.8 N m at 18 months, at every age (D, fitted with
`NEWBORN_ARM_SHARE` to supine newborns that lift a hand; 2.3 to 3 do).

MIMo gives abduction 4.0 N m, whereas adults' adduction is twice as strong as their abduction (Ivey et al. 1985, S)."""
MIDDLE = 1.8
"""Factor on MIMo's torque of the middle joints of four fingers, at every age: .6 of that of their knuckles, as in jars
that are opened with all strength (Purves & Berme 1980, .6 and 1.0 N m, S), and as the arms of the flexors' tendons at
both are (An et al. 1983, .61, M); MIMo has a third, with which the fingers of newborns are pulled open by 7 N (D)."""
GRASP = 5.0
GRASP_DECAY = Decay(4.0, 1.5)
"""By how much newborns' fingers are stronger than the law of the hand has it, relative to it: newborns hang by their
hands for 10 s or more (Robinson 1891, S), at 16 N a hand (D). The factor is fitted to that (D)."""


FASTEST_RAD_S = 35.0
"""Speed at which a fully active muscle no longer pulls, of every joint (D). Random commands then give joints at most 19
to 28 rad/s in 99.9 % of the time, 32 to 48 without it, and a newborn's hip turns by 71 degrees in .35 s."""


def motor_torques(
    volumes: RelativeVolumes, reference: Reference, growth: MaturationFactors | None
) -> tuple[Motor, ...]:
    """Return the motors of a child, in MIMo's order; without *growth*, by the published law."""
    groups, motors = reference.anatomy.groups, []
    for side, figures in reference.anatomy.motors:
        joint = figures.joint.format(side=side)
        torque_nm = figures.gear_nm * volumes[side][figures.driven_geom]
        name, driven_geom = figures.name.format(side=side), figures.driven_geom.format(side=side)
        tone = fastest_rad_s = None
        if growth:
            gain, _ = _gain(figures, groups[joint], growth)
            torque_nm *= gain
            fastest_rad_s = FASTEST_RAD_S
            tone = tone_of(figures.joint, size_gain(joint, groups[joint], growth), growth.mature_months)
        speed = figures.vmax_lengths_per_s
        motors.append(
            Motor(
                name,
                joint,
                torque_nm,
                figures.force_range,
                speed,
                driven_geom,
                figures.fmax,
                tone=tone,
                fastest_rad_s=fastest_rad_s,
            )
        )
    return tuple(motors)


def _gain(figures: ReferenceMotor, group: str, growth: MaturationFactors) -> tuple[float, str]:
    """Return the factor l r f on a torque T_18 v, for the neck also x what its head is heavier, and its reasons."""
    length, curve = growth.relative_length, STRENGTH[group]
    if group == EYES:
        why = f" x {length:.6g} ^ 2, standing height relative to 18 months, as their inertia grows by {LAW} (D)"
        return length**2, why
    share = curve(growth.mature_months)
    why = (
        f" x {length:.6g}, the standing height relative to 18 months, x {share:.6g}, the share of its strength at 18 "
        f"months that the {group} has at this age by {LAW} (row `{group}`: {curve.newborn:g} at birth, decay of "
        f"{curve.decay.tau_months:g} months and power {curve.decay.power:g}; {curve.source})"
    )
    gain = length * share * (growth.head_gain if group == NECK else growth.lean_gain)
    if growth.lean_gain != 1 and group != NECK:
        why += f" x {growth.lean_gain:.6g}, by which it is leaner than the average child of its age (D)"
    if figures.joint == "robot:{side}_shoulder_horizontal":
        why += f" x {HORIZONTAL_FLEXION:g} (adults' adduction is twice abduction, Ivey et al. 1985, S; fitted, D)"
        return gain * HORIZONTAL_FLEXION, why
    if figures.joint in FINGERS:
        grasp = 1 + GRASP * GRASP_DECAY(growth.mature_months)
        why += f" x {grasp:.6g}, by which newborns grasp harder (Robinson 1891, S; fitted, D)"
        if figures.joint.endswith("_middle"):
            why += f" x {MIDDLE:g}, .6 of the knuckle's torque (Purves & Berme 1980, S; An et al. 1983, M)"
            grasp *= MIDDLE
        return gain * grasp, why
    return gain, why + heavier(group, growth)


def at_strength_of_age(tree: BodyTree, now: Sequence[Motor], then: Sequence[Motor]) -> BodyTree:
    """Return a body as much stronger as the motors of the average child are at another age, *then*, than *now*."""
    motors = []
    for motor, usual, other in zip(tree.motors, now, then, strict=True):
        factor = other.gear_nm / usual.gear_nm
        gear_nm = motor.gear_nm * factor
        factors = ((STRENGTH_AGE_KEY, factor),)
        motors.append(replace(motor, gear_nm=gear_nm, force_range=other.force_range, factors=factors))
    return replace(tree, motors=tuple(motors))


def scale_strength(tree: BodyTree, strength: Mapping[str, float]) -> BodyTree:
    """Return a body with the factors on its gears that a spec asks for, by muscle group or pair of groups."""
    if not strength:
        return tree
    groups = tree.muscle_groups
    pair_of = {group: pair for pair, sides in PAIRED_GROUPS.items() for group in sides}
    motors = []
    for motor in tree.motors:
        group = groups[motor.joint]
        name = group if group in strength else pair_of.get(group, "")
        if name in strength:
            factors = ((f"{STRENGTH_KEY}.{name}", strength[name]), *motor.factors)
            fmax = tuple(force * strength[name] for force in motor.fmax)
            motor = replace(motor, gear_nm=motor.gear_nm * strength[name], fmax=fmax, factors=factors)
        motors.append(motor)
    return replace(tree, motors=tuple(motors))


def motor_origins(motor: Motor, figures: ReferenceMotor, group: str, tree: BodyTree) -> tuple[Origin, Origin]:
    """Return where the gear of a motor comes from, and its force range; *group* is what its strength matures with."""
    whose = "the average child of 18 months" if tree.growth else "the reference body"
    rule = (
        f"{figures.gear_nm:g} N m ({REFERENCE}) x volume / volume of {whose}, "
        f"of the geom that moves the joint: {motor.driven_geom}"
    )
    gear = Origin(rule, (f"geom.{motor.driven_geom}.size",))
    if tree.growth:
        _, why = _gain(figures, group, tree.growth)
        lean_keys = () if group in (EYES, NECK) else tree.growth.lean_keys
        gear = gear.times(why, LENGTH_KEY, AGE_KEY, LAW_KEY, *lean_keys)
        gear = gear if group == EYES else matured(gear, tree.growth)
    else:
        gear = gear.times(", by the law `published`", LAW_KEY)
    for key, factor in motor.factors:
        gear = gear.times(f" x {factor:.6g} ({key})", key)
    return gear, Origin(CONSTANT)


def published_fmax(motor: Motor, what: str) -> Origin:
    """Return where the strength of a motor's muscles comes from by the published law, where no age changes it."""
    factors = {key: factor for key, factor in motor.factors if key != STRENGTH_AGE_KEY}
    times = "".join(f" x {factor:.6g} ({key})" for key, factor in factors.items())
    return Origin(f"{what} ({REFERENCE}){times}{as_published('constant')}", (LAW_KEY, *factors))
