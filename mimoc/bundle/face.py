"""The face in a model: the material of the head, and with a skin the places of its vertices."""

from collections.abc import Callable, Mapping
from functools import cached_property

import mujoco
import numpy as np

from mimoc.base.errors import BundleError
from mimoc.base.geometry.meshes import Steps, stepped
from mimoc.bundle.arrays import Array
from mimoc.bundle.manifest import FaceEntry

MOVING = "face/moving"
"""The array of the head's vertices that any expression moves, as indices in the skin of the head, shape (n,)."""


def array_of(expression: str) -> str:
    """Return the name of the array of how far an expression moves these, in steps, shape (n, 3)."""
    return f"face/{expression}"


class Face:
    """The face of an infant, which can be shown in its model and in copies of it."""

    def __init__(self, entry: FaceEntry, arrays: Callable[[], Mapping[str, Array]]):
        self.entry, self._arrays = entry, arrays

    @cached_property
    def _moving(self) -> Array:
        return self._array(MOVING, "u", 1)

    @cached_property
    def _steps(self) -> dict[str, Steps]:
        steps = {name: self._array(array_of(name), "i", 2) for name in self.entry.shapes}
        if any(array.shape != (len(self._moving), 3) for array in steps.values()):
            raise BundleError("the arrays of the face do not fit each other; build the bundle again")
        return steps

    def _array(self, name: str, kind: str, dimensions: int) -> Array:
        array = self._arrays().get(name)
        if array is None or array.dtype.kind != kind or array.ndim != dimensions:
            raise BundleError(f"the bundle has no array {name!r} as faces need it; build it again")
        return array

    def shown(self, model: mujoco.MjModel) -> str | None:
        """Return the expression that a model shows, None if it is none of this face's."""
        names = self.entry.materials
        head = model.geom(self.entry.geom) if self.entry.skin is None else model.skin(self.entry.skin)
        texture = model.mat_texid[int(head.matid.item())]  # A head without a skin begins with a material of its own.
        alike = (name for name in names if (model.mat_texid[model.material(names[name]).id] == texture).all())
        return next(alike, None)

    def show(self, model: mujoco.MjModel, expression: str) -> None:
        """Let a model show an expression, which is one of this face's."""
        material = model.material(self.entry.materials[expression]).id
        if self.entry.skin is None:
            model.geom(self.entry.geom).matid = material
            return
        self._move(model, self.shown(model), expression)
        model.skin(self.entry.skin).matid = material

    def take_on(self, model: mujoco.MjModel) -> None:
        """Let the vertices follow the material in a model into which the skin has been written as it is built."""
        if self.entry.skin is not None:
            self._move(model, self.entry.begins, self.shown(model))

    def _move(self, model: mujoco.MjModel, before: str | None, after: str | None) -> None:
        if before == after or not self.entry.shapes:
            return
        head = model.skin(self.entry.skin).id
        first, count = int(model.skin_vertadr[head]), int(model.skin_vertnum[head])
        if len(self._moving) and int(self._moving.max()) >= count:
            raise BundleError("the arrays of the face do not fit the skin of the head; build the bundle again")
        rows = first + self._moving.astype(np.intp)
        now, then = (self._steps.get(name or "") for name in (before, after))
        model.skin_vert[rows] = stepped(model.skin_vert[rows], now, then)
