"""The part of the wrench at a free root that contact with the ground cannot give.

With the wrench w that inverse dynamics without contacts asks for at the root, and contacts that can push along the
edges of their friction pyramids, whose wrenches about the root are the columns of A, what is left over is

    r = w - A x,  x = argmin |S (w - A x)| over x >= 0  (non-negative least squares),

where S weighs 1 N m as 1 N at a distance of `ARM_M`. Forces of soft contacts, which say what millimetres of overlap
would give, are not used: no camera sees millimetres.
"""

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls

from mimoc.runtime.sense import FloatArray

NEAR_M = 0.01
"""Distance within which a part of the body counts as touching: what fits of one camera leave open (a choice)."""
ARM_M = 0.1
"""Lever at which torques are weighed as forces, about half an infant's trunk (a choice)."""


def with_margin(model: mujoco.MjModel, near_m: float = NEAR_M) -> mujoco.MjModel:
    """Return a copy of a model that lists contacts from this distance on."""
    copied = model.__copy__()
    copied.geom_margin[:] = np.maximum(copied.geom_margin, near_m)
    return copied


def unsupported(
    model: mujoco.MjModel, data: mujoco.MjData, is_own: npt.NDArray[np.bool_], root: int, wrench: FloatArray
) -> FloatArray:
    """Return what is left over of a wrench, shape (6,).

    Args:
        model: The infant and its world, with a margin; see `with_margin`.
        data: Its state, with contacts.
        is_own: Which bodies are the infant's, shape (bodies,).
        root: Body of the root.
        wrench: Force in the world's frame [N], and torque in the body's [N m], about its origin, shape (6,).
    """
    pushes = _pushes(model, data, is_own, root)
    if not len(pushes):
        return wrench
    scales = np.repeat([1.0, 1.0 / ARM_M], 3)
    sizes, _ = nnls(pushes.T * scales[:, None], wrench * scales, maxiter=50 * len(pushes))
    return wrench - sizes @ pushes


def _pushes(model: mujoco.MjModel, data: mujoco.MjData, is_own: npt.NDArray[np.bool_], root: int) -> FloatArray:
    """Return the wrench of a force of 1 N along each edge of each friction pyramid, shape (4 contacts, 6)."""
    contacts = data.contact
    ours = is_own[model.geom_bodyid[contacts.geom]]
    outside = ours[:, 0] != ours[:, 1]
    frames, second = contacts.frame[outside].reshape(-1, 3, 3), ours[outside, 1]
    normals, friction = frames[:, 0] * np.where(second, 1.0, -1.0)[:, None], contacts.friction[outside, :1]
    edges = np.stack([normals + way * friction * frames[:, axis] for axis in (1, 2) for way in (-1, 1)], axis=1)
    arms_m = (contacts.pos[outside] - data.xpos[root])[:, None]
    torques = np.cross(arms_m, edges) @ data.xmat[root].reshape(3, 3)  # In the body's frame.
    return np.concatenate([edges, torques], axis=2).reshape(-1, 6)
