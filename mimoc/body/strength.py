"""Strength: the torque of each motor by age and size, and what a spec asks for on top of it.

A motor's torque at full command is

    T = T_18 v l r

with MIMo's torque T_18 at 18 months, the volume v of the part that it moves and the standing height l, both relative to
18 months, and the share r of its muscle group's strength that an infant of that age has. The load of its joint grows by
v l, so r alone decides whether an infant can hold its own weight. By the published law, T = T_18 v.

No dynamometry of infants exists. The curves were fitted to milestones (D): with them, compiled infants held up their
heads, reached, sat and stood at the ages at which children do (WHO Multicentre Growth Reference Study Group 2006;
Denver II, Frankenburg et al. 1992; Gerber, Wilks & Erdie-Lalena 2010). Those of hands are a guess (D).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mimoc.body import origins
from mimoc.body.maturation import NECK, Decay, RelativeVolumes, heavier
from mimoc.body.origins import CONSTANT, LAW, LAW_KEY, LENGTH_KEY, REFERENCE, Origin
from mimoc.body.part import ReferenceMotor
from mimoc.body.published_figures import as_published
from mimoc.body.reference import Reference
from mimoc.body.tree import BodyTree, MaturationFactors, Motor
from mimoc.schema.names import PAIRED_GROUPS

STRENGTH_KEY = "spec.actuation.strength"
AGE_KEY = "spec.actuation.strength_age_months"


@dataclass(frozen=True, slots=True)
class StrengthCurve:
    """The relative strength of a group of muscles by age: r = 1 - (1 - newborn) decay(age)."""

    newborn: float
    """At birth."""
    decay: Decay

    def __call__(self, age_months: float) -> float:
        """Return the strength relative to that at 18 months, beyond what size explains."""
        return 1 - (1 - self.newborn) * self.decay(age_months)


STRENGTH: Mapping[str, StrengthCurve] = {
    "neck": StrengthCurve(0.15, Decay(7.0, 1.5)),
    "neck_front": StrengthCurve(0.15, Decay(6.0, 1.7)),
    "trunk": StrengthCurve(0.15, Decay(4.4, 1.8)),
    "arm": StrengthCurve(0.12, Decay(13.0, 2.0)),
    "hand": StrengthCurve(0.40, Decay(10.0, 1.5)),
    "hip": StrengthCurve(0.30, Decay(11.0, 1.4)),
    "knee": StrengthCurve(0.15, Decay(15.0, 2.0)),
    "ankle": StrengthCurve(0.10, Decay(16.0, 2.2)),
    "eyes": StrengthCurve(1.0, Decay(1.0, 1.0)),
}
"""By group of muscles that mature together (`Part.matures_with`); `neck` is its back and sides."""

FORWARDS: Mapping[str, str] = {"act:head_tilt": "neck_front"}
"""Motors whose torque towards positive angles comes from another group: the chin goes to the chest."""


def motor_torques(
    volumes: RelativeVolumes, reference: Reference, growth: MaturationFactors | None
) -> tuple[Motor, ...]:
    """Return the motors of a child, in MIMo's order; without *growth*, by the published law."""
    of_age = {group: curve(reference.age_months) for group, curve in STRENGTH.items()}
    groups, motors = reference.anatomy.groups, []
    for side, figures in reference.anatomy.motors:
        joint, torque_nm, force_range = figures.joint.format(side=side), figures.gear_nm, figures.force_range
        torque_nm *= volumes[side][figures.driven_geom]
        if growth:
            torque_nm, force_range = _maturing(torque_nm, figures, groups[joint], of_age, growth)
        name, driven_geom = figures.name.format(side=side), figures.driven_geom.format(side=side)
        speed = figures.vmax_lengths_per_s
        motors.append(Motor(name, joint, torque_nm, force_range, speed, driven_geom, figures.fmax))
    return tuple(motors)


def _maturing(
    torque_nm: float, figures: ReferenceMotor, group: str, of_age: Mapping[str, float], growth: MaturationFactors
) -> tuple[float, tuple[float, float]]:
    """Return the torque T_18 v l r, for the neck also x what its head is heavier, and the force range.

    *torque_nm* is T_18 v; *of_age* is the share r of each group that strength matures with.
    """
    negative, positive = of_age[group], of_age[FORWARDS.get(figures.name, group)]
    gain = growth.head_gain if group == NECK else 1.0
    low, high = figures.force_range
    return torque_nm * growth.relative_length * negative * gain, (low, high * (positive / negative))


def at_strength_of_age(tree: BodyTree, now: Sequence[Motor], then: Sequence[Motor]) -> BodyTree:
    """Return a body as much stronger as the motors of the average child are at another age, *then*, than *now*."""
    motors = []
    for motor, usual, other in zip(tree.motors, now, then, strict=True):
        factor = other.gear_nm / usual.gear_nm
        gear_nm, factors = motor.gear_nm * factor, ((AGE_KEY, factor),)
        motors.append(replace(motor, gear_nm=gear_nm, force_range=other.force_range, factors=factors))
    return replace(tree, motors=tuple(motors))


def scale_strength(tree: BodyTree, strength: Mapping[str, float]) -> BodyTree:
    """Return a body with the factors on its gears that a spec asks for, by muscle group or pair of groups."""
    if not strength:
        return tree
    groups, pair_of = tree.muscle_groups, {group: pair for pair, sides in PAIRED_GROUPS.items() for group in sides}
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
    gear, limits = Origin(rule, (f"geom.{motor.driven_geom}.size",)), Origin(CONSTANT)
    if tree.growth:
        strength = STRENGTH[group](tree.age_months)
        text = (
            f" x {tree.growth.relative_length:.6g}, the standing height relative to 18 months, x {strength:.6g}, the "
            f"share of its strength at 18 months that the {group} has at this age by {LAW} ({_row(group)})"
        )
        gear = gear.times(text + heavier(group, tree.growth), LENGTH_KEY, origins.AGE_KEY, LAW_KEY)
        if front := FORWARDS.get(figures.name):
            ratio = f"{STRENGTH[front](tree.age_months) / strength:.6g}, the strength of its front by that of its back"
            text = f"{REFERENCE}, towards positive angles x {ratio} at this age by {LAW} ({_row(front)}; {_row(group)})"
            limits = Origin(text, (origins.AGE_KEY, LAW_KEY))
    else:
        gear = gear.times(", by the law `published`", LAW_KEY)
    for key, factor in motor.factors:
        gear = gear.times(f" x {factor:.6g} ({key})", key)
    return gear, limits


def published_fmax(motor: Motor, what: str) -> Origin:
    """Return where the strength of a motor's muscles comes from by the published law, where no age changes it."""
    factors = {key: factor for key, factor in motor.factors if key != AGE_KEY}
    times = "".join(f" x {factor:.6g} ({key})" for key, factor in factors.items())
    return Origin(f"{what} ({REFERENCE}){times}{as_published('constant')}", (LAW_KEY, *factors))


def _row(group: str) -> str:
    """Return the row of a group in the table of strengths, with its source."""
    curve = STRENGTH[group]
    decay = f"decay of {curve.decay.tau_months:g} months and power {curve.decay.power:g}"
    others = {"hand": "a guess; D", "eyes": "the same at every age; D"}
    source = others.get(group, "fitted to the ages of milestones; D")
    return f"row `{group}`: {curve.newborn:g} at birth, {decay}; {source}"
