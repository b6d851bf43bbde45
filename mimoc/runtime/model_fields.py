"""What an episode changes in a model, declared, so that a state of an environment includes it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

WORLD = 0  # The body that everything hangs on.


@dataclass(frozen=True, slots=True)
class ModelField:
    """Some rows of an array of an `MjModel`."""

    name: str  # The array, such as `geom_size`.
    rows: npt.NDArray[np.intp]  # Indices of the rows, shape (n,).
    write: Callable[[mujoco.MjModel, npt.NDArray[Any]], None] | None = None
    """What writes other values into a model, if more has to follow them there."""


def rows_by_name(fields: Iterable[ModelField]) -> dict[str, npt.NDArray[np.intp]]:
    """Return the rows of each array that some fields declare, one declaration after another."""
    rows: dict[str, npt.NDArray[np.intp]] = {}
    for field in fields:
        rows[field.name] = np.concatenate([rows.get(field.name, field.rows[:0]), field.rows])
    return rows


class ModelFields:
    """All that episodes change in a model."""

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
        """Write what this model was before any episode into a copy of it."""
        ModelFields(model, self._fields).state = self._as_built

    def forget(self) -> None:
        """Let the model be as built again."""
        self.state = self._as_built

    def inherit(self, former: "ModelFields") -> None:
        """Take over what an episode has changed in the model of the same infant at another age.

        What it has left as it was built stays as it is built at this age.
        """
        built_now = zip(self.state, former._as_built, former.state, strict=True)
        self.state = [np.where(now == built, ours, now) for ours, built, now in built_now]
        if "body_mass" in {field.name for field in self._fields}:
            self._model.body_subtreemass[WORLD] = self._model.body_mass.sum()
