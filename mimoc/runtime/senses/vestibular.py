"""Balance: what the inner ear feels of the head's motion."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.runtime.senses.sense import FloatArray, IntArray
from mimoc.schema.manifest import ActuationEntry, VestibularEntry

MAX_ACCELERATION_M_S2 = 1e4
"""Bound of the observation; hard knocks of the head reach some hundreds."""
MAX_RATE_RAD_S = 1e3
"""Bound of the observation."""


@dataclass(frozen=True)
class Vestibular:
    """Specific force, then angular velocity, in the frame of the head: shape (6,), [m/s², rad/s]."""

    addresses: IntArray
    low: FloatArray
    high: FloatArray
    layout: tuple[str, ...]

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return the reading of both sensors."""
        return data.sensordata[self.addresses]


def bind_vestibular(entry: VestibularEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> Vestibular:
    """Find the sensors of *entry* in *model*."""
    names = (entry.accelerometer, entry.gyro)
    high = np.repeat([MAX_ACCELERATION_M_S2, MAX_RATE_RAD_S], 3)
    return Vestibular(
        addresses=np.concatenate([model.sensor(name).adr[0] + np.arange(3) for name in names]),
        low=-high,
        high=high,
        layout=tuple(
            f"{name}.{axis} [{unit}]" for name, unit in zip(names, ("m/s²", "rad/s"), strict=True) for axis in "xyz"
        ),
    )
