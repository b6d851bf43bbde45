"""Removal of limbs, with everything attached to them."""

from collections.abc import Collection
from dataclasses import replace

from mimoc.body.tree import BodyTree


def prune(tree: BodyTree, names: Collection[str]) -> BodyTree:
    """Return a body without the named parts, the parts attached to them, and all references to these."""
    if not names:
        return tree
    gone: set[str] = set()
    for body in tree.bodies:
        if body.name in names or body.parent in gone:
            gone.add(body.name)
    bodies = tuple(body for body in tree.bodies if body.name not in gone)
    joints = {joint.name for body in bodies for joint in body.joints}
    return replace(
        tree,
        bodies=bodies,
        motors=tuple(motor for motor in tree.motors if motor.joint in joints),
        tendons=tuple(tendon for tendon in tree.tendons if all(joint in joints for joint, _ in tendon.coefficients)),
        excluded=tuple(pair for pair in tree.excluded if gone.isdisjoint(pair)),
    )
