"""Noise of hearing: the level of what is heard varies."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.components.senses.hearing.run import Hearing, Waveform
from mimoc.runtime.noise.noise import Draw, Noise
from mimoc.runtime.sense import FloatArray


@dataclass(frozen=True)
class LevelNoise(Noise):
    """Adds noise to the level of each band that is heard; where nothing is heard, there is none."""

    deviation_db: FloatArray
    """Standard deviation of a level, shape (1,)."""

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, 2, channels), and no state."""
        heard = sample > 0
        noisy_db = sample + self.deviation_db[..., None] * draw.normals(sample.shape, heard)
        return draw.xp.where(heard, draw.xp.maximum(noisy_db, 0.0), 0.0), None


@dataclass(frozen=True)
class GainNoise(Noise):
    """Changes the level of the whole sound at each ear, from one sample of the sense to the next."""

    deviation_db: FloatArray
    """Standard deviation of the level, shape (1,)."""

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, 2, samples), and no state."""
        gains_db = self.deviation_db[..., None] * draw.normals((*sample.shape[:2], 1))
        return sample * 10 ** (gains_db / 20), None


def bind(amount_db: float, sense: Hearing, low_pass_s: float) -> LevelNoise | GainNoise:
    """Return the noise of a sense of hearing."""
    kind = GainNoise if isinstance(sense.output, Waveform) else LevelNoise
    return kind(np.array([amount_db]))
