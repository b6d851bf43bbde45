"""Strength that a spec asks for: factors by muscle group, and the strength of another age."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import prod

from mimoc.actuation.spec import ActuationSpec
from mimoc.body.assembly import Anatomy
from mimoc.body.growth import grow_average
from mimoc.body.tree import BodyTree
from mimoc.schema.names import PAIRED_GROUPS

STRENGTH_KEY = "spec.actuation.strength"
AGE_KEY = "spec.actuation.strength_age_months"


def scale_strength(tree: BodyTree, anatomy: Anatomy, spec: ActuationSpec) -> BodyTree:
    """Return a body with the gears that a spec asks for.

    Args:
        tree: The body, with the strength of its growth.
        anatomy: Of that body.
        spec: The factors, and the age that strength is taken from.
    """
    if not spec.strength and spec.strength_age_months is None:
        return tree
    groups = muscle_groups(tree)
    if spec.strength_age_months is not None:
        tree = _of_another_age(tree, anatomy, spec.strength_age_months)
    motors = []
    for motor in tree.motors:
        factors = (*_of_group(groups[motor.joint], spec.strength), *motor.factors)
        asked = prod(factor for _, factor in _of_group(groups[motor.joint], spec.strength))
        motors.append(replace(motor, gear_nm=motor.gear_nm * asked, factors=factors))
    return replace(tree, motors=tuple(motors))


def muscle_groups(tree: BodyTree) -> Mapping[str, str]:
    """Return the muscle group that moves each joint."""
    of_body = body_groups(tree)
    return {joint.name: of_body[body.name] for body in tree.bodies for joint in body.joints}


def body_groups(tree: BodyTree) -> Mapping[str, str]:
    """Return the muscle group that moves each body."""
    found: dict[str, str] = {}
    for body in tree.bodies:
        found[body.name] = body.group or found[body.parent or body.name]
    return found


def _of_group(group: str, strength: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield key and factor of a group, if it has one: its own, or else that of its pair."""
    pairs = [pair for pair, sides in PAIRED_GROUPS.items() if group in sides]
    named = [name for name in (group, *pairs) if name in strength]
    yield from ((f"{STRENGTH_KEY}.{name}", strength[name]) for name in named[:1])


def _of_another_age(tree: BodyTree, anatomy: Anatomy, age_months: float) -> BodyTree:
    """Return a body as strong as it would be at another age, by as much as the average child is then."""
    ages_months = (tree.age_months, age_months)
    now, then = (grow_average(age, anatomy, tree.development).motors for age in ages_months)
    motors = []
    for motor, here, there in zip(tree.motors, now, then, strict=True):
        factor = there.gear_nm / here.gear_nm
        factors = ((AGE_KEY, factor),)
        motors.append(replace(motor, gear_nm=motor.gear_nm * factor, force_range=there.force_range, factors=factors))
    return replace(tree, motors=tuple(motors))
