"""Head and eyes that look at something by themselves, and so tell where it is."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.model_fields import ModelField
from mimoc.mujoco_layout import LOCK_ANGLE
from mimoc.senses.sense import FloatArray
from mimoc.tasks.base import GazeEntry

ROUNDS = 12
"""Turns of every joint, one after the other, until all look there: each leaves less than half of what it found."""


class Gaze:
    """Locked joints of the head and the eyes whose angles follow what is looked at.

    Each joint in turn goes to the angle about its axis that brings the looker's x axis nearest to the direction of
    the target: cyclic coordinate descent (Wang & Chen 1991).
    """

    def __init__(self, entries: Sequence[GazeEntry], model: mujoco.MjModel, constraints: ConstraintsEntry):
        """Find joints, lookers and locks in *model*."""
        joints = [model.joint(entry.joint) for entry in entries]
        self._model = model
        self._joints = [joint.id for joint in joints]
        self._angles = np.array([joint.qposadr[0] for joint in joints], int)
        self._speeds = np.array([joint.dofadr[0] for joint in joints], int)
        self._low, self._high = np.array([joint.range for joint in joints]).reshape(-1, 2).T
        self._lookers = [model.body(entry.looker).id for entry in entries]
        lock_of = {lock.joint: lock.equality for lock in constraints.locks}
        self._locks = np.array([model.equality(lock_of[entry.joint]).id for entry in entries], np.intp)

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What it changes in the model: the angles of the locks."""
        return (ModelField("eq_data", self._locks),)

    def start(self, data: mujoco.MjData, target: FloatArray) -> None:
        """Look at a place in the world, shape (3,), [m], at once."""
        for _ in range(ROUNDS):
            data.qpos[self._angles] = self._turned(data, target)
            mujoco.mj_kinematics(self._model, data)
        self._model.eq_data[self._locks, LOCK_ANGLE] = data.qpos[self._angles]

    def follow(self, data: mujoco.MjData, target: FloatArray) -> None:
        """Go on looking at a place: the locks pull the joints there."""
        self._model.eq_data[self._locks, LOCK_ANGLE] = self._turned(data, target)

    def _turned(self, data: mujoco.MjData, target: FloatArray) -> FloatArray:
        """Return the angle of each joint that looks at the target, as far as its range goes, the others as they are."""
        angles = data.qpos[self._angles].copy()
        for index, (joint, looker) in enumerate(zip(self._joints, self._lookers, strict=True)):
            axis, forward = data.xaxis[joint], data.xmat[looker].reshape(3, 3)[:, 0]
            towards = target - data.xpos[looker]
            across = forward @ towards - (axis @ forward) * (axis @ towards)
            angles[index] += np.arctan2(axis @ np.cross(forward, towards), across)
        return np.clip(angles, self._low, self._high)
