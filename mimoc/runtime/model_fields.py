"""What episodes change in a model, declared so that states of an environment include it.

Locked joints, parts that are held where a reset puts them, and the facial expression are declared here.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import check_name
from mimoc.base.mujoco_layout import LOCK_ANGLE, WELD_ANCHOR, WELD_PLACE, WELD_TURN
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ConstraintsEntry, Manifest
from mimoc.bundle.variants import Face
from mimoc.runtime.sense import FloatArray, IntArray

WORLD = 0  # The body that everything hangs on.


@dataclass(frozen=True, slots=True)
class ModelField:
    """Some rows of an array of an `MjModel`."""

    name: str  # The array, such as `geom_size`.
    rows: npt.NDArray[np.intp]  # Indices of the rows, shape (n,).
    write: Callable[[mujoco.MjModel, npt.NDArray[Any]], None] | None = None  # Writes values that more must follow.


def rows_by_name(fields: Iterable[ModelField]) -> dict[str, npt.NDArray[np.intp]]:
    """Return the declared rows of each array."""
    rows: dict[str, npt.NDArray[np.intp]] = {}
    for field in fields:
        rows[field.name] = np.concatenate([rows.get(field.name, field.rows[:0]), field.rows])
    return rows


class ModelFields:
    """Everything that episodes change in a model."""

    def __init__(self, model: mujoco.MjModel, fields: Iterable[ModelField]):
        self._model, self._fields = model, tuple(fields)
        self._arrays = [(getattr(model, field.name), field.rows) for field in self._fields]
        self._as_built = self.state

    @property
    def state(self) -> list[npt.NDArray[np.generic]]:
        """A copy of the rows of each field; setting it writes them to the model."""
        return [array[rows] for array, rows in self._arrays]

    @state.setter
    def state(self, state: list[npt.NDArray[np.generic]]) -> None:
        for field, (array, rows), values in zip(self._fields, self._arrays, state, strict=True):
            if field.write is None:
                array[rows] = values
            elif not np.array_equal(array[rows], values):
                field.write(self._model, values)

    def write_as_built(self, model: mujoco.MjModel) -> None:
        """Write the values before any episode into a copy of the model."""
        ModelFields(model, self._fields).state = self._as_built

    def forget(self) -> None:
        """Reset the model to that as built."""
        self.state = self._as_built

    def inherit(self, former: "ModelFields") -> None:
        """Take over what an episode has changed in the model of the same infant at another age.

        What it has left as built stays as it is built at this age.
        """
        built_now = zip(self.state, former._as_built, former.state, strict=True)
        self.state = [np.where(now == built, ours, now) for ours, built, now in built_now]
        if "body_mass" in {field.name for field in self._fields}:
            self._model.body_subtreemass[WORLD] = self._model.body_mass.sum()


class Constraints:
    """The locks and welds of an infant."""

    def __init__(self, entry: ConstraintsEntry, model: mujoco.MjModel):
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
        """Lock joints and hold parts where they are in a state whose kinematics have been computed."""
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
        """Return where a held point of a body is in the world, shape (3,)."""
        return data.xpos[body] + data.xmat[body].reshape(3, 3) @ self._targets[weld, WELD_ANCHOR]


def _turned(orientation: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    back, turn, turned = np.empty(4), np.empty(4), np.empty(4)
    mujoco.mju_negQuat(back, before)
    mujoco.mju_mulQuat(turn, after, back)
    mujoco.mju_mulQuat(turned, turn, orientation)
    return turned


def face_of(bundle: Bundle) -> Face | None:
    """Return the face of an infant, None if it has none."""
    return Face(bundle.manifest.face, lambda: bundle.arrays) if bundle.manifest.face else None


def set_expression(expression: str, face: Face | None, model: mujoco.MjModel) -> None:
    """Change the facial expression of an infant."""
    check_name("facial expression of this infant", expression, face.entry.materials if face else ())
    assert face
    face.show(model, expression)


def expression_of(manifest: Manifest, model: mujoco.MjModel) -> str | None:
    """Return the facial expression that an infant has now; None if it has no face, or another."""
    nothing: Mapping[str, np.ndarray] = {}
    return Face(manifest.face, lambda: nothing).shown(model) if manifest.face else None


def expression_fields(face: Face | None, model: mujoco.MjModel) -> tuple[ModelField, ...]:
    """Return what the expression changes in the model."""
    if face is None:
        return ()
    if face.entry.skin is None:
        return (ModelField("geom_matid", np.array([model.geom(face.entry.geom).id])),)
    return (ModelField("skin_matid", np.array([model.skin(face.entry.skin).id]), _Follower(face)),)


class _Follower:
    """Moves the vertices of a face when its material is written."""

    def __init__(self, face: Face):
        self._face = face

    def __call__(self, model: mujoco.MjModel, values: np.ndarray) -> None:
        names = {model.material(material).id: name for name, material in self._face.entry.materials.items()}
        self._face.show(model, names[int(values[0])])
