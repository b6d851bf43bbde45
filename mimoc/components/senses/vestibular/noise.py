"""Noise of balance: what is felt of rotation and acceleration wanders about the truth."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.units import deg_to_rad
from mimoc.runtime.noise.noise import Draw, LowPass, Noise
from mimoc.runtime.sense import FloatArray, Sense

THRESHOLDS = {"m/s²": 0.03, "rad/s": deg_to_rad(1.0)}
"""What adults just feel, by unit: .6 to 2 deg/s and .01 to .05 m/s² at 1 Hz (from memory, M)."""
BANDWIDTH_HZ = 5.0
"""Up to which the noise is white (derived, D)."""


@dataclass(frozen=True)
class VestibularNoise(Noise):
    """Adds low-passed white noise to each number."""

    deviation: FloatArray
    """Standard deviation of each number in its unit, shape (n,)."""
    low_pass: LowPass

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, n), and its noise with standard deviation 1."""
        state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
        return sample + self.deviation * state, state


def bind(amount: float, sense: Sense, low_pass_s: float) -> VestibularNoise:
    """Return the noise of a sense of balance, by the units of its numbers."""
    units = [name.rsplit("[", 1)[1].rstrip("]") for name in sense.layout]
    return VestibularNoise(
        amount * np.array([THRESHOLDS[unit] for unit in units]), LowPass(1 / (2 * math.pi * BANDWIDTH_HZ))
    )
