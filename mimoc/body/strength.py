"""Strength that a spec asks for: factors by muscle group, and the strength of another age."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import prod

from mimoc.actuation.spec import ActuationSpec
from mimoc.body.assembly import Anatomy
from mimoc.body.grow import grow
from mimoc.body.tree import BodyTree
from mimoc.fits import measure
from mimoc.schema.names import PAIRED_GROUPS, SIDES

_SIDED_GROUPS = {"upper_arm": "arm", "hand": "hand", "upper_leg": "leg"}
GROUPS = {
    "lower_body": "trunk",
    "head": "neck",
    **{f"{side}_eye": "eyes" for side in SIDES},
    **{f"{side}_{body}": f"{side}_{group}" for side in SIDES for body, group in _SIDED_GROUPS.items()},
}
"""Muscle group by the first body that it moves; it includes all bodies below, up to where the next group begins."""

STRENGTH_KEY = "spec.actuation.strength"
AGE_KEY = "spec.actuation.strength_age_months"


def scale_strength(tree: BodyTree, anatomy: Anatomy, spec: ActuationSpec) -> BodyTree:
    """Return a body with the gears that a spec asks for.

    Args:
        tree: The body, with the strength of its growth.
        anatomy: Of that body.
        spec: The factors, and the age that strength is taken from.
    """
    groups = muscle_groups(tree)
    ages = {} if spec.strength_age_months is None else _age_factors(tree, anatomy, spec.strength_age_months)
    motors = []
    for motor in tree.motors:
        factors = (*_of_group(groups[motor.joint], spec.strength), *ages.get(motor.name, ()))
        gear_nm = motor.gear_nm * prod(factor for _, factor in factors)
        motors.append(replace(motor, gear_nm=gear_nm, factors=factors))
    return replace(tree, motors=tuple(motors))


def muscle_groups(tree: BodyTree) -> Mapping[str, str]:
    """Return the muscle group that moves each joint."""
    of_body = body_groups(tree)
    return {joint.name: of_body[body.name] for body in tree.bodies for joint in body.joints}


def body_groups(tree: BodyTree) -> Mapping[str, str]:
    """Return the muscle group that moves each body."""
    found: dict[str | None, str] = {}
    for body in tree.bodies:
        found[body.name] = GROUPS.get(body.name) or found.get(body.parent, "trunk")
    return {body.name: found[body.name] for body in tree.bodies}


def _of_group(group: str, strength: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield key and factor of a group, if it has one: its own, or else that of its pair."""
    pairs = [pair for pair, sides in PAIRED_GROUPS.items() if group in sides]
    named = [name for name in (group, *pairs) if name in strength]
    yield from ((f"{STRENGTH_KEY}.{name}", strength[name]) for name in named[:1])


def _age_factors(tree: BodyTree, anatomy: Anatomy, age_months: float) -> Mapping[str, tuple[tuple[str, float]]]:
    """Return how much stronger the average child of another age is, by motor, with the key that says so."""
    now, then = (grow(measure(age), anatomy).motors for age in (tree.age_months, age_months))
    return {here.name: ((AGE_KEY, there.gear_nm / here.gear_nm),) for here, there in zip(now, then, strict=True)}
