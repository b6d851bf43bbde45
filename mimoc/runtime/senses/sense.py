"""What every sense is."""

from typing import Protocol

import mujoco
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]


class Sense(Protocol):
    """A reading of the simulation, as numbers with known bounds and meaning."""

    @property
    def low(self) -> FloatArray:
        """Least reading, shape (n,)."""
        ...

    @property
    def high(self) -> FloatArray:
        """Largest reading, shape (n,)."""
        ...

    @property
    def layout(self) -> tuple[str, ...]:
        """What each of the n numbers is, with its unit."""
        ...

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return the reading now, shape (n,), a fresh array."""
        ...
