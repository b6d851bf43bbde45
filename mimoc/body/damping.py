"""Scaling of damping and armature with above-average strength, so that no joint moves faster than MIMo's."""

from collections.abc import Iterator
from dataclasses import replace

from mimoc.body.assembly import Anatomy
from mimoc.body.growth import grow_average
from mimoc.body.tree import Body, BodyTree, Joint

NOISE = 1e-9
"""Relative difference below which two strengths count as equal."""


def scale_damping(tree: BodyTree, anatomy: Anatomy) -> BodyTree:
    """Return a body whose damping and armature are scaled with any strength above average.

    If a motor is stronger than that of the average child of the same age, because a spec makes a part or a child larger
    or stronger, its joint's damping and armature grow with it, as far as needed for neither the speed at which damping
    balances the motor's torque nor the acceleration of the armature under this torque to exceed MIMo's, or those of
    the average child if they are more.

    Args:
        tree: The body, with its final strength.
        anatomy: Anatomy of that body.
    """
    average = grow_average(tree.age_months, anatomy, tree.development)
    factors = {} if tree is average else dict(_factors(tree, average, anatomy))
    return replace(tree, bodies=tuple(_scale_body(body, factors) for body in tree.bodies)) if factors else tree


def _factors(tree: BodyTree, average: BodyTree, anatomy: Anatomy) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield the joints whose motors are too strong for their damping or armature, with the factors of both."""
    here = average.joints
    there = {joint.name.format(side=side): joint for side, part in anatomy.parts for joint in part.joints}
    for motor, usual, (_, figures) in zip(tree.motors, average.motors, anatomy.motors, strict=True):
        joint, at_18 = here[motor.joint], there[motor.joint]
        damping, armature = (
            max(1.0, motor.gear_nm / max(usual.gear_nm, figures.gear_nm * now / then))
            for now, then in (
                (joint.damping_nms_per_rad, at_18.damping_nms_per_rad),
                (joint.armature_kgm2, at_18.armature_kgm2),
            )
        )
        if max(damping, armature) > 1 + NOISE:
            yield motor.joint, (damping, armature)


def _scale_body(body: Body, factors: dict[str, tuple[float, float]]) -> Body:
    if not any(joint.name in factors for joint in body.joints):
        return body
    joints = (_scale_joint(joint, *factors[joint.name]) if joint.name in factors else joint for joint in body.joints)
    return replace(body, joints=tuple(joints))


def _scale_joint(joint: Joint, damping: float, armature: float) -> Joint:
    return replace(
        joint,
        damping_nms_per_rad=damping * joint.damping_nms_per_rad,
        armature_kgm2=armature * joint.armature_kgm2,
    )
