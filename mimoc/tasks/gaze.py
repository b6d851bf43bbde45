"""Gaze control: head and eyes that follow a target, so that proprioception encodes its position."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.errors import BundleError
from mimoc.model_fields import ModelField
from mimoc.mujoco_layout import LOCK_ANGLE
from mimoc.senses.sense import FloatArray
from mimoc.tasks.base import GazeEntry

ROUNDS = 12
"""Iterations over all joints until the gaze reaches the target: each reduces the error by more than half."""
_NEXT, _LAST = [1, 2, 0], [2, 0, 1]
"""The axes after x, y and z, and those before them, in a circle."""


class Gaze:
    """Locked joints of the head and the eyes, whose angles follow a target.

    Each joint in turn is set to the angle that brings the x axis of its head or eye nearest to the direction of the
    target: cyclic coordinate descent (Wang & Chen 1991).
    """

    def __init__(self, entries: Sequence[GazeEntry], model: mujoco.MjModel, constraints: ConstraintsEntry):
        """Find joints, lookers and locks in *model*.

        Raises:
            BundleError: If a joint is not locked.
        """
        joints = [model.joint(entry.joint) for entry in entries]
        self._model = model
        self._joints = [joint.id for joint in joints]
        self._angles = np.array([joint.qposadr[0] for joint in joints], int)
        self._speeds = np.array([joint.dofadr[0] for joint in joints], int)
        self._low, self._high = np.array([joint.range for joint in joints]).reshape(-1, 2).T
        self._lookers = [model.body(entry.looker).id for entry in entries]
        lock_of = {lock.joint: lock.equality for lock in constraints.locks}
        for entry in entries:
            if entry.joint not in lock_of:
                raise BundleError(f"its gaze turns '{entry.joint}', which is not locked; build it again")
        self._locks = np.array([model.equality(lock_of[entry.joint]).id for entry in entries], np.intp)

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """Fields of the model that it changes: the angles of the locks."""
        return (ModelField("eq_data", self._locks),)

    def start(self, data: mujoco.MjData, target: FloatArray) -> None:
        """Turn the gaze to a position in the world, shape (3,), [m], at once."""
        for _ in range(ROUNDS):
            data.qpos[self._angles] = self._turned(data, target)
            mujoco.mj_kinematics(self._model, data)
        self._model.eq_data[self._locks, LOCK_ANGLE] = data.qpos[self._angles]

    def follow(self, data: mujoco.MjData, target: FloatArray) -> None:
        """Keep the gaze on a position: the locks pull the joints to the new angles."""
        self._model.eq_data[self._locks, LOCK_ANGLE] = self._turned(data, target)

    def _turned(self, data: mujoco.MjData, target: FloatArray) -> FloatArray:
        """Return the joint angles with the gaze on the target, within their ranges; other joints are unchanged."""
        axes, forward = data.xaxis[self._joints], data.xmat[self._lookers, ::3]
        towards = target - data.xpos[self._lookers]
        across = _dots(forward, towards) - _dots(axes, forward) * _dots(axes, towards)
        turns = np.arctan2(_dots(axes, _crosses(forward, towards)), across)
        return np.clip(data.qpos[self._angles] + turns, self._low, self._high)


def _dots(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the scalar product of each pair of rows, shape (n,)."""
    return np.einsum("ij,ij->i", first, second)


def _crosses(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the vector product of each pair of rows, shape (n, 3); a tenth of the time of NumPy's."""
    return first[:, _NEXT] * second[:, _LAST] - first[:, _LAST] * second[:, _NEXT]
