"""An infant that has grown, lifted out of what it would sink into."""

import mujoco
import numpy as np

LEFT_M = 1e-4
"""Penetration that is left, so that what supports the infant goes on to do so; as in the poses of `body.poses`."""
ROUNDS = 10
"""Most times that it is lifted: what it is lifted out of is above it, or beside it, the rest of them."""
UPWARDS = 0.1
"""Least vertical part of a contact's normal at which lifting helps."""


def settle(model: mujoco.MjModel, data: mujoco.MjData, root_body: str) -> None:
    """Lift an infant by as much as it sinks into what it lies, sits or stands on.

    Args:
        model: The infant and its world.
        data: Its state; of what is derived from it, the positions are computed anew.
        root_body: The infant's root, which has a free joint.
    """
    root = model.body(root_body).id
    height = model.jnt_qposadr[model.body_jntadr[root]] + 2
    infants = model.body_rootid[model.geom_bodyid] == root
    for _ in range(ROUNDS):
        mujoco.mj_fwdPosition(model, data)
        contact = data.contact
        own = infants[contact.geom]
        alone = own[:, 0] != own[:, 1]
        upwards = contact.frame[alone, 2] * np.where(own[alone, 1], 1.0, -1.0)
        deep = contact.dist[alone] < -LEFT_M
        deep &= upwards > UPWARDS
        if not deep.any():
            return
        data.qpos[height] += (-(contact.dist[alone] + LEFT_M)[deep] / upwards[deep]).max()
