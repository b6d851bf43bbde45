"""Flicker: how fast changes can be seen, as a low-pass filter of first order over time.

    seen = seen before + (1 - exp(-2 pi f t)) (now - seen before)

for pictures t apart, which is exact for what stays as it is from one picture to the next. It filters what the infant
sees otherwise, after acuity, contrast and colour, and begins with the first picture of an episode.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.components.senses.vision import VisionEntry
from mimoc.runtime.filter import Filter


@dataclass(frozen=True)
class Persistence(Filter):
    """The filter of pictures in 8 bits."""

    flicker_hz: npt.NDArray[np.float64]
    """f, shape (1,)."""

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the pictures that are seen, in 8 bits, and without rounding; see `Filter`."""
        now = xp.astype(sample, xp.float32)
        if state is None:
            return sample, now
        rows = xp.reshape(xp.astype(self.flicker_hz, xp.float32), (-1, *[1] * (len(sample.shape) - 1)))
        seen = state + (1.0 - xp.exp(rows * (-2 * math.pi * elapsed_s))) * (now - state)
        return xp.astype(xp.round(seen), xp.uint8), seen


def filter_of(entry: VisionEntry) -> Persistence | None:
    """Return the filter of an infant's pictures; None if it has none."""
    return None if entry.flicker_hz is None else Persistence(np.array([entry.flicker_hz]))
