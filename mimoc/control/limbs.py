"""Limbs: the chains of bodies that are attached to the trunk."""

from collections.abc import Collection

import mujoco

from mimoc.bundle.manifest import AnatomyEntry


def trunk_of(anatomy: AnatomyEntry, model: mujoco.MjModel) -> tuple[int, ...]:
    """Return the bodies of the trunk, from the first to the last."""
    return tuple(model.body(name).id for name in anatomy.trunk)


def limb_of(body: int, trunk: Collection[int], model: mujoco.MjModel) -> int:
    """Return the first body of the limb that a body belongs to; 0, the world, for bodies that are not in a limb."""
    while body not in trunk and body:
        parent = int(model.body_parentid[body])
        if parent in trunk:
            return body
        body = parent
    return 0


def joints_between(model: mujoco.MjModel, body: int, root: int) -> list[int]:
    """Return the joints that move a body relative to the parent of *root*, its ancestor or itself."""
    joints: list[int] = []
    while True:
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = [*range(first, first + count), *joints]
        if body == root:
            return joints
        body = int(model.body_parentid[body])
