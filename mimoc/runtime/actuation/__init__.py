"""Actuation: from an action to the controls of the model."""

from collections.abc import Callable, Mapping
from typing import Protocol

import mujoco
import numpy as np

from mimoc.runtime.actuation.muscle import bind_muscle
from mimoc.runtime.actuation.position import bind_position
from mimoc.runtime.actuation.torque import bind_torque
from mimoc.runtime.senses.sense import FloatArray
from mimoc.schema.manifest import ActuationEntry


class Actuation(Protocol):
    """What turns an action into controls."""

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

    def __call__(self, action: np.ndarray, data: mujoco.MjData) -> None:
        """Set the controls for the next physics steps."""
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
