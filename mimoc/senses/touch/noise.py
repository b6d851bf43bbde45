"""Noise of touch: the size of each force that is felt varies, its direction does not."""

import numpy as np

from mimoc.senses.sense import Sample
from mimoc.senses.touch.run import Touch


class TouchNoise:
    """Adds noise to the size of each force, which is never less than zero; where nothing touches, nothing is felt.

    The noise of each sample is independent of the one before.
    """

    state = None

    def __init__(self, deviation_n: float, width: int):
        """Disturb forces.

        Args:
            deviation_n: Standard deviation of the size of a force.
            width: How many numbers of a sample make a force.
        """
        self._deviation_n, self._width = deviation_n, width

    def __call__(self, sample: Sample, elapsed_s: float, generator: np.random.Generator) -> Sample:
        """Return a sample with noise."""
        forces = sample.reshape(-1, self._width)
        sizes_n = np.linalg.norm(forces, axis=1)
        felt = np.flatnonzero(sizes_n)
        noisy_n = sizes_n[felt] + self._deviation_n * generator.standard_normal(len(felt))
        forces[felt] *= (np.maximum(noisy_n, 0.0) / sizes_n[felt])[:, None]
        return sample


def bind(amount_n: float, sense: Touch, low_pass_s: float) -> TouchNoise:
    """Return the noise of a sense of touch."""
    return TouchNoise(amount_n, sense.width)
