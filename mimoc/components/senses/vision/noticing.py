"""The field within which an infant notices things: beyond it, pictures fade to their mean."""

import functools
import math
from typing import Any

import numpy as np
import numpy.typing as npt

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
