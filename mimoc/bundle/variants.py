"""An infant at some age with its model, which shows its face, alone or in a world of several infants."""

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol, Self

import mujoco
import numpy as np

from mimoc.base.errors import BundleError
from mimoc.base.geometry.meshes import Steps, stepped
from mimoc.bundle.io import Array, Bundle, read_bundle
from mimoc.bundle.manifest import FaceEntry
from mimoc.bundle.model import load_model
from mimoc.bundle.world import WorldBundle

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


@dataclass(eq=False)
class Variant:
    """An infant at some age in some scene."""

    bundle: Bundle
    bare: mujoco.MjModel  # Its model, which belongs to whoever asked for it and may be changed.
    _dress: Callable[[mujoco.MjModel], None] | None = None
    """Writes the skin of this age into the model, if that has still that of another one."""

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.bundle, self.model)

    @property
    def model(self) -> mujoco.MjModel:
        """Its model with its skin, which is written into it when somebody first asks for this.

        It takes longer than all else that another age does, and what does not draw the infant can do with `bare`: the
        same model, maybe with an earlier skin.
        """
        if self._dress is not None:
            self._dress(self.bare)
            self._dress = None
            if face := self.bundle.manifest.face:
                Face(face, lambda: self.bundle.arrays).take_on(self.bare)
        return self.bare

    def again(self, model: mujoco.MjModel | None = None) -> Self:
        """Return the same infant with a model of its own: a copy, or a model that was copied from it before."""
        return type(self)(self.bundle, copy.copy(self.bare) if model is None else model, self._dress)


def open_variant(source: Variant | Bundle | str | Path) -> Variant:
    """Return an infant with its model; a BundleError or a ModelError says why there is none."""
    if isinstance(source, Variant):
        return source
    bundle = source if isinstance(source, Bundle) else read_bundle(source)
    return Variant(bundle, load_model(bundle))


class Variants(Protocol):
    """Makes an infant at any age and in any scene; it can be copied and pickled."""

    @property
    def has_other_scenes(self) -> bool:
        """Whether it makes scenes of other seeds than the infant's own."""
        ...

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months, in the scene of a seed, or raise a MimocError and change nothing."""
        ...


@dataclass(eq=False)
class WorldVariant(Variant):
    """Several infants in one world, each at some age."""

    bundle: WorldBundle  # pyright: ignore[reportIncompatibleVariableOverride] - Whoever asks knows which of the two.


class WorldMaker(Protocol):
    """Makes a world with its infants at any ages and in any scene; it can be copied and pickled."""

    @property
    def has_other_scenes(self) -> bool:
        """Whether it makes scenes of other seeds than the world's own."""
        ...

    def __call__(self, ages_months: Mapping[str, float], scene_seed: int) -> WorldVariant:
        """Return the world with infants of some ages, in months, in the scene of a seed, or raise a MimocError.

        Infants that are not named have the age of their spec. All keep their places, their clothes and their parts.
        """
        ...
