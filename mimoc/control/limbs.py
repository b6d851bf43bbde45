"""Limbs: what hangs on the trunk, from the first body to the last."""

import mujoco

TRUNK = ("hip", "lower_body", "upper_body", "chest")
"""The bodies that limbs hang on, from the first to the last; MIMo's names."""


def chest_of(model: mujoco.MjModel) -> int:
    """Return the last body of the trunk that a model has: a rigid chest can be of one piece with the upper body."""
    return max(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in TRUNK)


def limb_of(model: mujoco.MjModel, body: int) -> int:
    """Return the body next to the trunk that a body hangs on, or is; 0, the world, for what is not of a limb."""
    trunk = {mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in TRUNK}
    while body not in trunk and body:
        parent = int(model.body_parentid[body])
        if parent in trunk:
            return body
        body = parent
    return 0


def joints_between(model: mujoco.MjModel, body: int, root: int) -> list[int]:
    """Return the joints that move a body relative to the parent of *root*, which it hangs on, or is."""
    found: list[int] = []
    while True:
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        found = [*range(first, first + count), *found]
        if body == root:
            return found
        body = int(model.body_parentid[body])
