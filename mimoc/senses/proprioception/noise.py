"""Noise of proprioception: sensed angles drift about the true ones, and sensed velocities with them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.noise.low_pass import Smooth
from mimoc.noise.noise import Draw, Noise
from mimoc.senses.proprioception.run import ANGLE_UNIT, VELOCITY_UNIT
from mimoc.senses.sense import FloatArray, IntArray, Sense
from mimoc.units import deg_to_rad


@dataclass(frozen=True)
class ProprioceptionNoise(Noise):
    """Adds a smooth error to each angle, and the error's rate to each velocity; torques and limits are exact."""

    deviation_rad: FloatArray
    """Standard deviation of an angle, shape (1,)."""
    count: int
    """Number of angles, n."""
    errors: IntArray
    """Of each number of a sample, the place of its error among those of n angles, of n velocities, and no error."""
    low_pass: Smooth

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, size), and its errors with their rates, shape (k, 2, n)."""
        xp = draw.xp
        state = self.low_pass(xp, state, draw.elapsed_s, draw.normals((sample.shape[0], 2, self.count)))
        errors = [state[:, 0, :], state[:, 1, :] / self.low_pass.time_constant_s]
        errors = [*(self.deviation_rad * error for error in errors), xp.zeros_like(sample[:, :1])]
        return sample + xp.take(xp.concat(errors, axis=1), self.errors, axis=1), state


def bind(amount_deg: float, sense: Sense, low_pass_s: float) -> ProprioceptionNoise:
    """Return the noise of a sense of proprioception; its velocities are in the order of its angles, if it has any."""
    angles, velocities = (
        np.flatnonzero([name.endswith(f"[{unit}]") for name in sense.layout]) for unit in (ANGLE_UNIT, VELOCITY_UNIT)
    )
    count = len(angles)
    errors = np.full(len(sense.layout), 2 * count)
    errors[angles] = np.arange(count)
    errors[velocities] = count + np.arange(len(velocities))
    return ProprioceptionNoise(np.array([deg_to_rad(amount_deg)]), count, errors, Smooth(low_pass_s))
