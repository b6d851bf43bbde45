"""Balance: specific force and angular velocity of the head."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.senses.sense import FloatArray, IntArray, Sample, Vector
from mimoc.senses.vestibular.spec import VestibularEntry

MAX_ACCELERATION_M_S2 = 1e4
"""Bound of the observation; hard knocks of the head reach some hundreds."""
MAX_RATE_RAD_S = 1e3
"""Bound of the observation."""


class Vestibular(Vector):
    """Specific force, then angular velocity, in the frame of the head: shape (3,) each, [m/s², rad/s]."""

    def __init__(self, layout: Sequence[str], high: FloatArray, bodies: IntArray, addresses: IntArray):
        """Read MuJoCo's sensor data at some addresses."""
        super().__init__("vestibular", layout, -high, high, bodies)
        self._addresses = addresses
        self.expression = tuple(addresses.tolist())

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the readings of its sensors."""
        return self.measure(data)

    def measure(self, data: Any, *constants: FloatArray) -> Sample:
        """Return the readings of the sensors of an infant, or of many."""
        return data.sensordata.take(self._addresses, -1)


def bind(entry: VestibularEntry, model: mujoco.MjModel, bundle: Bundle) -> Vestibular:
    """Find the sensors of *entry* in *model*."""
    wanted = ((entry.accelerometer, MAX_ACCELERATION_M_S2, "m/s²"), (entry.gyro, MAX_RATE_RAD_S, "rad/s"))
    sensors = [(name, high, unit) for name, high, unit in wanted if name]
    high = np.repeat([high for _, high, _ in sensors], 3)
    sites = [model.sensor(name).objid[0] for name, _, _ in sensors]
    return Vestibular(
        layout=[f"{name}.{axis} [{unit}]" for name, _, unit in sensors for axis in "xyz"],
        high=high,
        bodies=np.repeat(model.site_bodyid[sites], 3),
        addresses=np.concatenate([model.sensor(name).adr[0] + np.arange(3) for name, _, _ in sensors]),
    )
