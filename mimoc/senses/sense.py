"""What every sense is."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
Reading = npt.NDArray[Any]
Observation = dict[str, npt.NDArray[Any]]


class Sense(Protocol):
    """What is read off a simulation, and how an agent sees it."""

    @property
    def spaces(self) -> Mapping[str, Box]:
        """What an agent sees of it, by name in the observation."""
        ...

    @property
    def layout(self) -> tuple[str, ...]:
        """What each number is, with its unit, in the order of the observation."""
        ...

    @property
    def bodies(self) -> IntArray:
        """The body in which each number of a reading is felt, shape (n,); for delays that are longer in the legs."""
        ...

    def __call__(self, data: mujoco.MjData) -> Reading:
        """Return the reading now, an array of its own."""
        ...

    def observe(self, reading: Reading) -> Observation:
        """Return a reading, of now or of earlier, as fresh arrays within their spaces."""
        ...

    def follow(self, model: mujoco.MjModel) -> bool:
        """Go with the infant into another scene, or return False: then a new sense must be bound there."""
        ...

    def close(self) -> None:
        """Free what the sense holds; it is not read any more."""
        ...


@dataclass(frozen=True)
class Vector:
    """What senses have in common that are one vector of n numbers."""

    name: str
    """In the observation."""
    low: FloatArray
    """Least number to be observed, shape (n,)."""
    high: FloatArray
    """Largest number to be observed, shape (n,)."""
    bodies: IntArray
    """The body in which each number is felt, shape (n,)."""

    @property
    def spaces(self) -> Mapping[str, Box]:
        """The space of the vector."""
        return {self.name: Box(self.low.astype(np.float32), self.high.astype(np.float32), dtype=np.float32)}

    def observe(self, reading: Reading) -> Observation:
        """Return the reading within its bounds; unlike `np.clip`, in two calls that cost next to nothing."""
        observed = np.maximum(reading, self.low)
        np.minimum(observed, self.high, out=observed)
        return {self.name: observed.astype(np.float32)}

    def follow(self, model: mujoco.MjModel) -> bool:
        """Return False: what costs next to nothing is bound anew."""
        return False

    def close(self) -> None:
        """Do nothing: numbers hold nothing."""
