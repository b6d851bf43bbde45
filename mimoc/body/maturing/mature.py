"""Application of the law `maturing` to a body that has grown by the published law."""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

from mimoc.body.assembly import Anatomy
from mimoc.body.maturing.joints import (
    EXTRA_STIFFNESS,
    LOWER_LIMITS,
    NEWBORN_REST_DEG,
    POWERS,
    TONE,
    UPPER_LIMITS,
    Limit,
)
from mimoc.body.maturing.strength import FORWARDS, NECK, STRENGTH
from mimoc.body.tree import BodyTree, Growth, Joint, Motor


def mature(tree: BodyTree, anatomy: Anatomy, growth: Growth) -> BodyTree:
    """Return a body with the strength, passive joints, rest angles and ranges of its age.

    Args:
        tree: The body by the published law.
        anatomy: Its parts, joints and motors.
        growth: Its size relative to 18 months.
    """
    groups, names = maturing_groups(anatomy), sided_names(anatomy)
    tone = TONE(tree.age_months)

    def joint_of(joint: Joint) -> Joint:
        scales = passive_scales(joint.name, groups[joint.name], growth)
        return _joint(joint, names[joint.name], tree.age_months, tone, scales)

    bodies = (replace(body, joints=tuple(map(joint_of, body.joints))) for body in tree.bodies)
    motors = (
        _motor(motor, figures.name, groups[motor.joint], tree.age_months, growth)
        for motor, (_, figures) in zip(tree.motors, anatomy.motors, strict=True)
    )
    return replace(tree, bodies=tuple(bodies), motors=tuple(motors), growth=growth)


def relative_volumes(tree: BodyTree, anatomy: Anatomy) -> dict[str, float]:
    """Return the volume that each joint's strength follows, relative to 18 months, by joint.

    A joint without a motor has that of the joint that a tendon couples it to, as the second vertebra's joints.

    Args:
        tree: The body by the published law, whose gears are in proportion to these volumes.
        anatomy: Its motors at 18 months.
    """
    found = {
        motor.joint: motor.gear_nm / figures.gear_nm
        for motor, (_, figures) in zip(tree.motors, anatomy.motors, strict=True)
    }
    for tendon in tree.tendons:
        (first, _), (second, _) = tendon.coefficients
        found.setdefault(second, found[first])
    return found


@lru_cache(maxsize=16)
def maturing_groups(anatomy: Anatomy) -> Mapping[str, str]:
    """Return the group that each joint's strength matures with, by joint."""
    of_part: dict[str, str] = {}
    found: dict[str, str] = {}
    for side, part in anatomy.parts:
        own = part.matures_with or part.group.removeprefix("{side}_")
        of_part[part.name.format(side=side)] = own or of_part[(part.parent or "").format(side=side)]
        found |= {joint.name.format(side=side): of_part[part.name.format(side=side)] for joint in part.joints}
    return MappingProxyType(found)


@lru_cache(maxsize=16)
def sided_names(anatomy: Anatomy) -> Mapping[str, str]:
    """Return the name with `{side}` of each joint."""
    named = ((joint.name.format(side=side), joint.name) for side, part in anatomy.parts for joint in part.joints)
    return MappingProxyType(dict(named))


def passive_scales(joint: str, group: str, growth: Growth) -> dict[str, float]:
    """Return the factors of size on a joint's stiffness, friction, damping and armature, by attribute."""
    size = growth.relative_volumes[joint] * (growth.head_gain if group == NECK else 1.0)
    return {attribute: size * length for attribute, length in _length_scales(growth.relative_length).items()}


@lru_cache(maxsize=8)
def _length_scales(relative_length: float) -> Mapping[str, float]:
    """Return the factors of the standing height on what all joints have, by attribute."""
    return MappingProxyType({attribute: relative_length**power for attribute, power in POWERS.items()})


def stiffening(joint: str, tone: float) -> float:
    """Return how much stiffer a joint, named with `{side}`, is by some flexor tone (1 at birth)."""
    return 1 + EXTRA_STIFFNESS.get(joint, 0.0) * tone


def strengths(motor: str, group: str, age_months: float) -> tuple[float, float]:
    """Return the strength of a motor towards negative and positive angles, relative to that at 18 months."""
    return _strength(group, age_months), _strength(FORWARDS.get(motor, group), age_months)


@lru_cache(maxsize=64)
def _strength(group: str, age_months: float) -> float:
    return STRENGTH[group](age_months)


def _motor(motor: Motor, name: str, group: str, age_months: float, growth: Growth) -> Motor:
    negative, positive = strengths(name, group, age_months)
    gain = growth.head_gain if group == NECK else 1.0
    low, high = motor.force_range
    return replace(
        motor,
        gear_nm=motor.gear_nm * growth.relative_length * negative * gain,
        force_range=(low, high * (positive / negative)),
    )


def _joint(joint: Joint, name: str, age_months: float, tone: float, scales: Mapping[str, float]) -> Joint:
    rest_deg = joint.springref_deg + (NEWBORN_REST_DEG.get(name, joint.springref_deg) - joint.springref_deg) * tone
    low, high = joint.range_deg
    low, high = _limit(LOWER_LIMITS.get(name), low, age_months), _limit(UPPER_LIMITS.get(name), high, age_months)
    return replace(
        joint,
        range_deg=(low, high),
        springref_deg=min(max(rest_deg, low), high),
        stiffness_nm_per_rad=joint.stiffness_nm_per_rad * scales["stiffness"] * stiffening(name, tone),
        frictionloss_nm=joint.frictionloss_nm * scales["frictionloss"],
        damping_nms_per_rad=joint.damping_nms_per_rad * scales["damping"],
        armature_kgm2=joint.armature_kgm2 * scales["armature"],
    )


def _limit(limit: Limit | None, at_18_deg: float, age_months: float) -> float:
    return at_18_deg + (limit.newborn_deg - at_18_deg) * limit.decay(age_months) if limit else at_18_deg
