"""Flicker: how fast changes can be seen, as a low-pass filter of first order over time.

    seen = seen before + (1 - exp(-2 pi f t)) (now - seen before)

for pictures t apart, which is exact for what stays as it is from one picture to the next. It filters what the infant
sees otherwise, after acuity, contrast and colour, and begins with the first picture of an episode.
"""

import functools
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


Planes = npt.NDArray[np.float32]
"""Shape (height, width)."""

EDGE_DEG = 10.0
"""Within which visibility falls from 1 to 0, as half a cosine: a choice."""


@functools.lru_cache(maxsize=32)
def noticed_share(width_px: int, height_px: int, fovy_deg: float, noticed_deg: float) -> Planes:
    """Return how much of each pixel is noticed, shape (height, width), from 0 to 1; read-only.

    It is 1 up to *noticed_deg* from the line of sight, and 0 from 10° more on. In a picture so coarse that the middle
    of each pixel is beyond that, the pixels next to the line of sight are noticed.
    """
    tangent = 2 * math.tan(math.radians(fovy_deg) / 2) / height_px
    across, down = ((np.arange(size) + 0.5 - size / 2) * tangent for size in (width_px, height_px))
    angles_deg = np.degrees(np.arctan(np.hypot(down[:, None], across)))
    beyond = ((angles_deg - noticed_deg) / EDGE_DEG).clip(0, 1)
    share = (0.5 + 0.5 * np.cos(np.pi * beyond)).astype(np.float32)
    if not share.any():
        share = np.isclose(angles_deg, angles_deg.min()).astype(np.float32)
    share.flags.writeable = False
    return share


def fade(pictures: Any, share: Any) -> Any:
    """Return pictures of any array library that fade to the mean of what is noticed, each colour to its own.

    Args:
        pictures: Shape (..., height, width, colours).
        share: How much of each pixel is noticed, shape (..., height, width, 1 or colours).
    """
    noticed = pictures * share
    mean = noticed.sum((-3, -2))[..., None, None, :] / share.sum((-3, -2))[..., None, None, :]
    return noticed + mean * (1 - share)
