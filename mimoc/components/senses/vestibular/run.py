"""Balance: specific force and angular velocity of the head."""

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.components.senses.vestibular import CanalsEntry, VestibularEntry
from mimoc.runtime.filter import Lags, lags_of
from mimoc.runtime.noise import Draw, LowPass, Noise
from mimoc.runtime.sense import FloatArray, Sense, TermSense
from mimoc.runtime.term import Field

MAX_ACCELERATION_M_S2 = 1e4  # Bound of the observation; hard knocks of the head reach some hundreds.
MAX_RATE_RAD_S = 1e3  # Bound of the observation.
THRESHOLDS = {"m/s²": 0.03, "rad/s": math.radians(1.0)}
"""What adults just feel, by unit: .6 to 2 deg/s and .01 to .05 m/s² at 1 Hz (from memory, M)."""
BANDWIDTH_HZ = 5.0  # Up to which the noise is white (derived, D).


def bind(entry: VestibularEntry, model: mujoco.MjModel, bundle: Bundle) -> TermSense:
    """Return specific force, then angular velocity, in the frame of the head: shape (3,) each, [m/s², rad/s]."""
    wanted = ((entry.accelerometer, MAX_ACCELERATION_M_S2, "m/s²"), (entry.gyro, MAX_RATE_RAD_S, "rad/s"))
    sensors = [(model.sensor(name), high, unit) for name, high, unit in wanted if name]
    high = np.repeat([high for _, high, _ in sensors], 3)
    sense = TermSense(
        "vestibular",
        Field("sensordata", np.concatenate([sensor.adr[0] + np.arange(3) for sensor, *_ in sensors])),
        [f"{sensor.name}.{axis} [{unit}]" for sensor, _, unit in sensors for axis in "xyz"],
        -high,
        high,
        np.repeat(model.site_bodyid[[sensor.objid[0] for sensor, *_ in sensors]], 3),
    )
    if entry.canals and entry.gyro:
        sense.filter = _canals(entry.canals, len(high))
    return sense


def _canals(canals: CanalsEntry, count: int) -> Lags:
    """Return the dynamics of the canals, through which the last three of *count* numbers pass.

    H(s) = A s / (1 + A s) · T s / (1 + T s) · (1 + L s) / (1 + l s), with adaptation A, time constant T, lead L, lag l.
    """
    leads_s, lags_s = ((canals.lead_s,), (canals.lag_s,)) if canals.lag_s else ((), ())
    return lags_of(count, (canals.adaptation_s, canals.time_constant_s), leads_s, lags_s, first=count - 3)


@dataclass(frozen=True)
class VestibularNoise(Noise):
    """Adds low-passed white noise to each number."""

    deviation: FloatArray  # Standard deviation of each number in its unit, shape (n,).
    low_pass: LowPass

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, n), and its noise with standard deviation 1."""
        state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
        return sample + self.deviation * state, state


def bind_noise(amount: float, sense: Sense, low_pass_s: float) -> VestibularNoise:
    """Return the noise of a sense of balance, by the units of its numbers."""
    units = [name.rsplit("[", 1)[1].rstrip("]") for name in sense.layout]
    return VestibularNoise(
        amount * np.array([THRESHOLDS[unit] for unit in units]), LowPass(1 / (2 * math.pi * BANDWIDTH_HZ))
    )
