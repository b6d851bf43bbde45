"""Dampers and armatures that keep up with strength, so that no joint is swung faster than an average child's."""

from collections.abc import Iterator
from dataclasses import replace

from mimoc.body.assembly import Anatomy
from mimoc.body.grow import grow
from mimoc.body.tree import Body, BodyTree, Joint
from mimoc.fits import measure

NOISE = 1e-9
"""What the last digits of equal strengths may differ by."""


def steady(tree: BodyTree, anatomy: Anatomy) -> BodyTree:
    """Return a body whose joints are damped, and have armature, as what is extraordinary in their strength asks for.

    A joint's damping and armature are MIMo's at every age, and strength follows the volume of a part. Where a motor is
    stronger than the average child's of that age and of 18 months, because a spec makes a part or a child larger or
    says so, both grow as much as it does: neither the speed at which the damper takes up all of its torque nor what
    its torque makes of the armature exceed what they are in MIMo.

    Args:
        tree: The body, as strong as it is going to be.
        anatomy: Of that body.
    """
    factors = dict(_factors(tree, anatomy))
    return replace(tree, bodies=tuple(_steady_body(body, factors) for body in tree.bodies)) if factors else tree


def _factors(tree: BodyTree, anatomy: Anatomy) -> Iterator[tuple[str, float]]:
    """Yield the joints whose motors are stronger than ordinary, and how many times."""
    average = grow(measure(tree.age_months), anatomy).motors
    for motor, usual, (_, figures) in zip(tree.motors, average, anatomy.motors, strict=True):
        ordinary_nm = max(usual.gear_nm, figures.gear_nm)
        if motor.gear_nm > ordinary_nm * (1 + NOISE):
            yield motor.joint, motor.gear_nm / ordinary_nm


def _steady_body(body: Body, factors: dict[str, float]) -> Body:
    return replace(body, joints=tuple(_steady_joint(joint, factors.get(joint.name, 1.0)) for joint in body.joints))


def _steady_joint(joint: Joint, factor: float) -> Joint:
    return replace(
        joint,
        damping_nms_per_rad=factor * joint.damping_nms_per_rad,
        armature_kgm2=factor * joint.armature_kgm2,
    )
