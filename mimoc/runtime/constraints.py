"""Joints that are locked and parts that are held where a reset puts them."""

import mujoco
import numpy as np

from mimoc.base.mujoco_layout import LOCK_ANGLE, WELD_ANCHOR, WELD_PLACE, WELD_TURN
from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.sense import FloatArray, IntArray


class Constraints:
    """The locks and welds of an infant."""

    def __init__(self, entry: ConstraintsEntry, model: mujoco.MjModel):
        """Find them in *model*, whose equality constraints they set."""
        self._targets = model.eq_data
        self._locks = np.array([model.equality(lock.equality).id for lock in entry.locks], np.intp)
        self._angles = np.array([model.joint(lock.joint).qposadr[0] for lock in entry.locks], np.intp)
        self._dofs = np.array([model.joint(lock.joint).dofadr[0] for lock in entry.locks], np.intp)
        self._at_zero = model.qpos0[self._angles]
        self._ranges = model.jnt_range[[model.joint(lock.joint).id for lock in entry.locks]].reshape(-1, 2)
        self._welds = [(model.equality(weld.equality).id, model.body(weld.body).id) for weld in entry.welds]

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What they change in the model."""
        welds = [weld for weld, _ in self._welds]
        return (ModelField("eq_data", np.array([*self._locks.tolist(), *welds], np.intp)),)

    @property
    def fixed_dofs(self) -> IntArray:
        """Degrees of freedom of what is locked, shape (n,)."""
        return self._dofs

    def keep(self, data: mujoco.MjData) -> None:
        """Lock joints and weld parts where they are in a state whose kinematics have been computed."""
        self._targets[self._locks, LOCK_ANGLE] = data.qpos[self._angles] - self._at_zero
        for weld, body in self._welds:
            self._targets[weld, WELD_PLACE] = self._held_m(weld, body, data)
            self._targets[weld, WELD_TURN] = data.xquat[body]

    def carry_on(self, former: "Constraints", before: mujoco.MjData, after: mujoco.MjData) -> None:
        """Keep joints and parts locked and held as in the *former* infant, which had another age.

        Locks stay at their angles, or at the nearest that their joints still reach. What is held moves with the place
        in the world that growth has moved it to, so that nothing is pulled.
        """
        angles = former._targets[former._locks, LOCK_ANGLE] + self._at_zero
        self._targets[self._locks, LOCK_ANGLE] = np.clip(angles, *self._ranges.T) - self._at_zero
        for (weld, body), (former_weld, _) in zip(self._welds, former._welds, strict=True):
            target = former._targets[former_weld]
            moved_m = self._held_m(weld, body, after) - former._held_m(former_weld, body, before)
            self._targets[weld, WELD_PLACE] = target[WELD_PLACE] + moved_m
            self._targets[weld, WELD_TURN] = _turned(target[WELD_TURN], before.xquat[body], after.xquat[body])

    def _held_m(self, weld: int, body: int, data: mujoco.MjData) -> FloatArray:
        """Return where the point of a body that a weld holds is in the world, shape (3,)."""
        return data.xpos[body] + data.xmat[body].reshape(3, 3) @ self._targets[weld, WELD_ANCHOR]


def _turned(orientation: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Return an orientation turned as a body has turned; quaternions, shape (4,) each."""
    back, turn, turned = np.empty(4), np.empty(4), np.empty(4)
    mujoco.mju_negQuat(back, before)
    mujoco.mju_mulQuat(turn, after, back)
    mujoco.mju_mulQuat(turned, turn, orientation)
    return turned
