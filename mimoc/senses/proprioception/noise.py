"""Noise of proprioception: sensed angles drift about the true ones, and sensed velocities with them."""

import numpy as np

from mimoc.noise.low_pass import Smooth
from mimoc.senses.proprioception.run import ANGLE_UNIT, VELOCITY_UNIT
from mimoc.senses.sense import FloatArray, IntArray, Sample, Sense
from mimoc.units import deg_to_rad


class ProprioceptionNoise:
    """Adds a smooth error to each angle, and the error's rate to each velocity; torques and limits are exact."""

    def __init__(self, deviation_rad: float, angles: IntArray, velocities: IntArray, low_pass_s: float):
        """Disturb a sense.

        Args:
            deviation_rad: Standard deviation of an angle.
            angles: Places of the n angles in a sample, shape (n,).
            velocities: Places of their velocities, shape (n,), or (0,) if they are not sensed.
            low_pass_s: Time constant of the errors.
        """
        self._deviation_rad, self._angles, self._velocities = deviation_rad, angles, velocities
        self._errors = Smooth(len(angles), low_pass_s)

    def __call__(self, sample: Sample, elapsed_s: float, generator: np.random.Generator) -> Sample:
        """Return a sample with noise."""
        errors, rates_per_s = self._errors.advance(elapsed_s, generator)
        sample[self._angles] += self._deviation_rad * errors
        if len(self._velocities):
            sample[self._velocities] += self._deviation_rad * rates_per_s
        return sample

    @property
    def state(self) -> FloatArray:
        """The present errors."""
        return self._errors.values

    @state.setter
    def state(self, state: FloatArray) -> None:
        self._errors.values = state


def bind(amount_deg: float, sense: Sense, low_pass_s: float) -> ProprioceptionNoise:
    """Return the noise of a sense of proprioception."""
    angles, velocities = (
        np.flatnonzero([name.endswith(f"[{unit}]") for name in sense.layout]) for unit in (ANGLE_UNIT, VELOCITY_UNIT)
    )
    return ProprioceptionNoise(deg_to_rad(amount_deg), angles, velocities, low_pass_s)
