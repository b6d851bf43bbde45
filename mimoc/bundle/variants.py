"""Infants at other ages, or in the scene of another seed, alone or in one world, as environments are handed them."""

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import mujoco

from mimoc.bundle.face import Face
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.world import WorldBundle


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

    def again(self, model: mujoco.MjModel | None = None) -> "Variant":
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
