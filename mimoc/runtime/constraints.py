"""Joints that are locked and parts that are held where a reset puts them."""

import mujoco
import numpy as np

from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.model_fields import ModelField
from mimoc.mujoco_layout import LOCK_ANGLE, WELD_ANCHOR, WELD_PLACE, WELD_TURN


class Constraints:
    """The locks and welds of an infant."""

    def __init__(self, entry: ConstraintsEntry, model: mujoco.MjModel):
        """Find them in *model*, whose equality constraints they set."""
        self._targets = model.eq_data
        self._locks = np.array([model.equality(lock.equality).id for lock in entry.locks], np.intp)
        self._angles = np.array([model.joint(lock.joint).qposadr[0] for lock in entry.locks], np.intp)
        self._at_zero = model.qpos0[self._angles]
        self._welds = [(model.equality(weld.equality).id, model.body(weld.body).id) for weld in entry.welds]

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What they change in the model."""
        welds = [weld for weld, _ in self._welds]
        return (ModelField("eq_data", np.array([*self._locks.tolist(), *welds], np.intp)),)

    def keep(self, data: mujoco.MjData) -> None:
        """Lock joints and weld parts where they are in a state whose kinematics have been computed."""
        self._targets[self._locks, LOCK_ANGLE] = data.qpos[self._angles] - self._at_zero
        for weld, body in self._welds:
            point = self._targets[weld, WELD_ANCHOR]
            self._targets[weld, WELD_PLACE] = data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
            self._targets[weld, WELD_TURN] = data.xquat[body]
