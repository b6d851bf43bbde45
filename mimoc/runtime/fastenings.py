"""What of an infant is kept as a reset puts it: locked joints and held parts."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.bundle.manifest import FasteningsEntry
from mimoc.senses.sense import FloatArray

ANCHOR, PLACE, TURN = slice(0, 3), slice(3, 6), slice(6, 10)
"""Where a weld to the world has, among MuJoCo's numbers of a constraint, its point in the frame of the body, and place
and quaternion in the world."""
ANGLE = 0
"""Where a lock has its angle."""


class Fastenings:
    """The constraints of a model that keep joints and parts."""

    def __init__(self, entry: FasteningsEntry, model: mujoco.MjModel):
        """Find them in *model*, whose constraints they set."""
        self._targets = model.eq_data
        self._locks = np.array([model.equality(lock.equality).id for lock in entry.locks], int)
        self._angles = np.array([model.joint(lock.joint).qposadr[0] for lock in entry.locks], int)
        self._at_zero = model.qpos0[self._angles]
        self._lock_of = {lock.joint: lock_id for lock, lock_id in zip(entry.locks, self._locks.tolist(), strict=True)}
        self._welds = [(model.equality(weld.equality).id, model.body(weld.body).id) for weld in entry.welds]

    def keep(self, data: mujoco.MjData) -> None:
        """Keep everything as it is in a state whose kinematics are known."""
        self._targets[self._locks, ANGLE] = data.qpos[self._angles] - self._at_zero
        for weld, body in self._welds:
            point = self._targets[weld, ANCHOR]
            self._targets[weld, PLACE] = data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
            self._targets[weld, TURN] = data.xquat[body]

    def find(self, joints: Sequence[str]) -> FloatArray:
        """Return the indices of the locks of some joints."""
        return np.array([self._lock_of[joint] for joint in joints], int)

    @property
    def state(self) -> FloatArray:
        """Where everything is kept, shape (n, m)."""
        return self._targets[self._all].copy()

    @state.setter
    def state(self, targets: FloatArray) -> None:
        self._targets[self._all] = targets

    @property
    def _all(self) -> list[int]:
        return [*self._locks.tolist(), *(weld for weld, _ in self._welds)]
