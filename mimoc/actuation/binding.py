"""Actuation: from an action to the controls of the model."""

from collections.abc import Callable, Mapping
from typing import Protocol

import mujoco
import numpy.typing as npt

from mimoc.actuation.muscle.run import bind_muscle
from mimoc.actuation.position.run import bind_position
from mimoc.actuation.torque.run import bind_torque
from mimoc.bundle.manifest import ActuationEntry
from mimoc.senses.sense import FloatArray, IntArray


class Actuation(Protocol):
    """What turns an action into controls."""

    @property
    def actuators(self) -> IntArray:
        """Index of each actuator in the model, shape (n,)."""
        ...

    @property
    def low(self) -> FloatArray:
        """Least command, shape (n,)."""
        ...

    @property
    def high(self) -> FloatArray:
        """Largest command, shape (n,)."""
        ...

    @property
    def limits_nm(self) -> FloatArray:
        """Largest torque of each actuator towards negative and positive angles, shape (n, 2)."""
        ...

    def __call__(self, action: npt.ArrayLike) -> FloatArray:
        """Return the control of each actuator, shape (n,), an array of its own."""
        ...

    def effort(self, data: mujoco.MjData) -> float:
        """Return what the actuators' work costs now."""
        ...


ACTUATIONS: Mapping[str, Callable[[ActuationEntry, mujoco.MjModel], Actuation]] = {
    "torque": bind_torque,
    "muscle": bind_muscle,
    "position": bind_position,
}
"""By actuation model."""

__all__ = ["ACTUATIONS", "Actuation"]
