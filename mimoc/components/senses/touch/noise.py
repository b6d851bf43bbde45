"""Noise of touch: the size of each force that is felt varies, its direction does not."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.components.senses.touch.run import Touch
from mimoc.runtime.noise.noise import Draw, Noise
from mimoc.runtime.sense import FloatArray


@dataclass(frozen=True)
class TouchNoise(Noise):
    """Adds noise to the size of each force, which is never less than zero; where nothing touches, nothing is felt.

    The noise of each sample is independent of the one before.
    """

    deviation_n: FloatArray
    """Standard deviation of the size of a force, shape (1,)."""
    width: int
    """How many numbers of a sample make a force."""

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, size), and no state."""
        xp = draw.xp
        forces = xp.reshape(sample, (sample.shape[0], -1, self.width))
        sizes_n = xp.sqrt(xp.sum(forces * forces, axis=-1))
        felt = sizes_n > 0
        noisy_n = xp.maximum(sizes_n + self.deviation_n * draw.normals(sizes_n.shape, felt), 0.0)
        factors = noisy_n / xp.where(felt, sizes_n, 1.0)
        return xp.reshape(forces * factors[..., None], sample.shape), None


def bind(amount_n: float, sense: Touch, low_pass_s: float) -> TouchNoise:
    """Return the noise of a sense of touch."""
    return TouchNoise(np.array([amount_n]), 1 if sense.channels else sense.width)
