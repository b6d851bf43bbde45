"""What an episode changes in a model, declared, so that a state of an environment includes it."""

from collections.abc import Iterable
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, slots=True)
class ModelField:
    """Some rows of an array of an `MjModel`."""

    name: str
    """The array, such as `geom_size`."""
    rows: npt.NDArray[np.intp]
    """Indices of the rows, shape (n,)."""


class ModelFields:
    """All that episodes change in a model."""

    def __init__(self, model: mujoco.MjModel, fields: Iterable[ModelField]):
        """Find the arrays in *model*."""
        self._arrays = [(getattr(model, field.name), field.rows) for field in fields]

    @property
    def state(self) -> list[npt.NDArray[np.generic]]:
        """A copy of the rows of each field; setting it writes them to the model."""
        return [array[rows] for array, rows in self._arrays]

    @state.setter
    def state(self, state: list[npt.NDArray[np.generic]]) -> None:
        for (array, rows), values in zip(self._arrays, state, strict=True):
            array[rows] = values
