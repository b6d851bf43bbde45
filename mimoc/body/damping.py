"""Scaling of damping and armature with above-average strength, so that no joint moves faster than MIMo's."""

from collections.abc import Iterator
from dataclasses import replace

from mimoc.body.assembly import Anatomy
from mimoc.body.growth import grow
from mimoc.body.tree import Body, BodyTree, Joint
from mimoc.fits import measure

NOISE = 1e-9
"""Relative difference below which two strengths count as equal."""


def scale_damping(tree: BodyTree, anatomy: Anatomy) -> BodyTree:
    """Return a body whose damping and armature are scaled with any strength above average.

    A joint's damping and armature are MIMo's at every age, and strength follows the volume of a part. If a motor is
    stronger than that of the average child both of the same age and of 18 months, because a spec makes a part or a
    child larger or stronger, both are multiplied by the same factor. Therefore neither the speed at which damping
    balances the motor's torque nor the acceleration of the armature under this torque exceeds MIMo's.

    Args:
        tree: The body, with its final strength.
        anatomy: Anatomy of that body.
    """
    factors = dict(_factors(tree, anatomy))
    return replace(tree, bodies=tuple(_scale_body(body, factors) for body in tree.bodies)) if factors else tree


def _factors(tree: BodyTree, anatomy: Anatomy) -> Iterator[tuple[str, float]]:
    """Yield the joints whose motors are stronger than average, with the factor."""
    average = grow(measure(tree.age_months), anatomy, development=tree.development).motors
    for motor, usual, (_, figures) in zip(tree.motors, average, anatomy.motors, strict=True):
        ordinary_nm = max(usual.gear_nm, figures.gear_nm)
        if motor.gear_nm > ordinary_nm * (1 + NOISE):
            yield motor.joint, motor.gear_nm / ordinary_nm


def _scale_body(body: Body, factors: dict[str, float]) -> Body:
    return replace(body, joints=tuple(_scale_joint(joint, factors.get(joint.name, 1.0)) for joint in body.joints))


def _scale_joint(joint: Joint, factor: float) -> Joint:
    return replace(
        joint,
        damping_nms_per_rad=factor * joint.damping_nms_per_rad,
        armature_kgm2=factor * joint.armature_kgm2,
    )
