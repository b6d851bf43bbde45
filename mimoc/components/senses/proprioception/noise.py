"""Noise of proprioception: sensed angles drift about the true ones, and sensed velocities with them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.units import deg_to_rad
from mimoc.components.senses.proprioception.run import ANGLE_UNIT, VELOCITY_UNIT
from mimoc.runtime.noise.noise import Draw, Noise, Smooth
from mimoc.runtime.sense import FloatArray, IntArray, Sense


@dataclass(frozen=True)
class ProprioceptionNoise(Noise):
    """Adds a smooth error to each angle, and the error's rate to each velocity; torques and limits are exact."""

    deviation_rad: FloatArray
    """Standard deviation of an angle, shape (1,)."""
    errors: IntArray
    """Of each number of a sample, the place of its error among those of n angles, then those of their velocities."""
    per: FloatArray
    """By what the error there is divided: 1 of angles, the time constant of velocities, and infinity of all else."""
    count: int
    """Number of angles, n."""
    low_pass: Smooth

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, size), and its errors, shape (k, 2 n); see `Smooth`."""
        drawn = draw.normals((sample.shape[0], 2 * self.count))
        state = self.low_pass(draw.xp, state, draw.elapsed_s, drawn)
        return sample + self.deviation_rad * (draw.xp.take(state, self.errors, axis=1) / self.per), state


def bind(amount_deg: float, sense: Sense, low_pass_s: float) -> ProprioceptionNoise:
    """Return the noise of a sense of proprioception; its velocities are in the order of its angles, if it has any."""
    angles, velocities = (
        np.flatnonzero([name.endswith(f"[{unit}]") for name in sense.layout]) for unit in (ANGLE_UNIT, VELOCITY_UNIT)
    )
    errors, per = np.zeros(len(sense.layout), np.intp), np.full(len(sense.layout), np.inf)
    errors[angles], per[angles] = np.arange(len(angles)), 1.0
    errors[velocities], per[velocities] = len(angles) + np.arange(len(velocities)), low_pass_s
    return ProprioceptionNoise(np.array([deg_to_rad(amount_deg)]), errors, per, len(angles), Smooth(low_pass_s))
