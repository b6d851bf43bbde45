"""Gaze control: head and eyes that follow a target, so that proprioception encodes its position."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.errors import BundleError
from mimoc.model_fields import ModelField
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.tasks.base import GazeEntry


@dataclass(frozen=True)
class Gaze(Term):
    """Angles of n joints of the head and the eyes that point the x axes of these at a target, shape (k, n), [rad].

    Each joint turns by the angle that brings the x axis f of its head or eye nearest to the direction t of the target,
    about its own axis a, as if the others stood still: cyclic coordinate descent (Wang & Chen 1991).

        turn = atan2(a · (f x t), f · t - (a · f) (a · t))
    """

    joints: IntArray
    """Shape (n,), as are all that follow."""
    angles: IntArray
    """Where the angles of the joints stand in qpos."""
    lookers: IntArray
    """The body that each joint turns."""
    low: FloatArray
    """The ranges of the joints, in [rad]."""
    high: FloatArray

    def __call__(self, worlds: Worlds, target_m: Any) -> Any:
        """Return the angles, within their ranges, for targets in the world, shape (k, 3), [m]."""
        xp = worlds.xp
        axes = xp.take(worlds.xaxis, self.joints, axis=1)
        forward = xp.take(worlds.xmat, self.lookers, axis=1)[..., 0]
        towards = target_m[:, None, :] - xp.take(worlds.xpos, self.lookers, axis=1)
        along = _dots(forward, towards) - _dots(axes, forward) * _dots(axes, towards)
        angles = xp.take(worlds.qpos, self.angles, axis=1) + xp.atan2(_triple(axes, forward, towards), along)
        return xp.minimum(xp.maximum(angles, self.low), self.high)


def bind_gaze(
    entries: Sequence[GazeEntry], model: mujoco.MjModel, constraints: ConstraintsEntry
) -> tuple[Gaze, ModelField]:
    """Find joints, lookers and locks in *model*: return the gaze, and the locks that hold it, in the same order.

    Raises:
        BundleError: If a joint is not locked.
    """
    joints = [model.joint(entry.joint) for entry in entries]
    lock_of = {lock.joint: lock.equality for lock in constraints.locks}
    for entry in entries:
        if entry.joint not in lock_of:
            raise BundleError(f"its gaze turns '{entry.joint}', which is not locked; build it again")
    low, high = np.array([joint.range for joint in joints]).reshape(-1, 2).T
    gaze = Gaze(
        joints=np.array([joint.id for joint in joints], int),
        angles=np.array([joint.qposadr[0] for joint in joints], int),
        lookers=np.array([model.body(entry.looker).id for entry in entries], int),
        low=low,
        high=high,
    )
    locks = np.array([model.equality(lock_of[entry.joint]).id for entry in entries], np.intp)
    return gaze, ModelField("eq_data", locks)


def _dots(first: Any, second: Any) -> Any:
    """Return the scalar products of vectors, shape (..., 3), in an order that does not depend on their number."""
    products = first * second
    return products[..., 0] + products[..., 1] + products[..., 2]


def _triple(axes: Any, first: Any, second: Any) -> Any:
    """Return the scalar triple products a · (f x t) of vectors, shape (..., 3)."""
    (x1, y1, z1), (x2, y2, z2) = ([vectors[..., axis] for axis in range(3)] for vectors in (first, second))
    across = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    return axes[..., 0] * across[0] + axes[..., 1] * across[1] + axes[..., 2] * across[2]
