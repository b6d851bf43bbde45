"""The same infant at another age, or in the scene of another seed, as an environment is handed it."""

from dataclasses import dataclass
from typing import Protocol

import mujoco

from mimoc.bundle.io import Bundle


@dataclass(frozen=True, slots=True)
class Variant:
    """An infant at some age in some scene."""

    bundle: Bundle
    """The infant."""
    model: mujoco.MjModel
    """Its model, which belongs to whoever asked for it and may be changed."""


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
