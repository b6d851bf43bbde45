"""The same infant at another age, or in the scene of another seed, as an environment is handed it."""

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import mujoco

from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.model import load_model


@dataclass(frozen=True, slots=True)
class Variant:
    """An infant at some age in some scene."""

    bundle: Bundle
    """The infant."""
    model: mujoco.MjModel
    """Its model, which belongs to whoever asked for it and may be changed."""

    def again(self) -> "Variant":
        """Return the same infant with a model of its own."""
        return Variant(self.bundle, copy.copy(self.model))


def opened(source: Variant | Bundle | str | Path) -> Variant:
    """Return an infant with its model.

    Raises:
        BundleError: If a folder is not an intact bundle.
        ModelError: If MuJoCo rejects its model.
    """
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
        """Return the infant at an age, in months, in the scene of a seed.

        Raises:
            MimocError: If there is no such infant; nothing has changed then.
        """
        ...
