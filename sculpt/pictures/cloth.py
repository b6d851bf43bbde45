"""The pictures of cloth: a pattern, a knitted band along the hems, and shades by how deep in a fold it is.

A picture has two garments, one above the other: the upper half of each is its band, the lower its pattern.
"""

from collections.abc import Mapping

import numpy as np
from pictures.cubes import over, within

from mimoc.geometry.rotations import FloatArray
from mimoc.looks.appearance import PANTS, TOP, Colour

ROWS_PX, COLUMNS_PX = 128, 32
"""Height and width of a picture."""
FOLD = (0.20, 0.26, 0.30)
"""How much darker cloth is in a fold: a little redder, too."""
PLACES: Mapping[str, int] = {"bodysuit": 0, "shirt": 1, "nappy": 0, "trousers": 1}
"""Which garment of its picture each is, from the bottom."""
BANDS: Mapping[str, float] = {"bodysuit": 5.0, "shirt": 7.0, "nappy": 7.0, "trousers": 8.0}
"""Breadth of the band along a hem, [mm]."""
SEEN = 2.2
"""Distance from a hem, in breadths of its band, up to which a place in the picture tells it."""
HIGH, MIDDLE, LOW = 0.96, 0.5, 0.06
"""Places at the hem, far from it, and deep in a fold, as shares of a garment's part of the picture."""

TOP_STRIPE: Colour = (252, 236, 196)
TOP_BAND: Colour = (232, 142, 92)
SUIT: Colour = (238, 232, 214)
SUIT_BAND: Colour = (142, 186, 170)
PANTS_BAND: Colour = (84, 128, 142)
NAPPY: Colour = (244, 244, 240)
NAPPY_BAND: Colour = (196, 218, 226)


def shade_of(place: int, bands: FloatArray, free: FloatArray) -> FloatArray:
    """Return heights in a picture, 0 to 1.

    Args:
        place: Of the garment, as in `PLACES`.
        bands: Distance from the nearest hem, in breadths of its band.
        free: How much of the space around is free, 0 to 1.
    """
    near = np.clip(bands / SEEN, 0, 1)
    within_part = HIGH - (HIGH - MIDDLE) * near - (MIDDLE - LOW) * (1 - free) * near**2
    return (place + within_part) / 2


def paint_top() -> FloatArray:
    """Return the colours of a shirt with stripes, and of a bodysuit below it."""
    across, _ = _places()
    stripes = within(0.25 - np.cos(2 * np.pi * across), 0.5)
    shirt = over(np.full((*across.shape, 3), TOP, np.float64), TOP_STRIPE, stripes)
    return np.vstack((_shaded(shirt, TOP_BAND), _shaded(np.full((*across.shape, 3), SUIT, np.float64), SUIT_BAND)))


def paint_bottom() -> FloatArray:
    """Return the colours of trousers, and of a nappy below them."""
    across, _ = _places()
    plain = [np.full((*across.shape, 3), colour, np.float64) for colour in (PANTS, NAPPY)]
    return np.vstack((_shaded(plain[0], PANTS_BAND), _shaded(plain[1], NAPPY_BAND)))


def _places() -> tuple[FloatArray, FloatArray]:
    """Return how far each texel of a garment is to the right, and its height, 0 to 1."""
    right = (np.arange(COLUMNS_PX, dtype=np.float64) + 0.5) / COLUMNS_PX
    up = 1 - (np.arange(ROWS_PX // 2, dtype=np.float64) + 0.5) / (ROWS_PX // 2)
    across, height = np.meshgrid(right, up)
    return across, height


def _shaded(image: FloatArray, band: Colour) -> FloatArray:
    """Return a garment with its band, and darker in folds."""
    _, height = _places()
    edge = HIGH - (HIGH - MIDDLE) / SEEN
    image = over(image, band, np.clip((height - edge) * (ROWS_PX // 2) + 0.5, 0, 1))
    deep = np.clip((MIDDLE - height) / (MIDDLE - LOW), 0, 1)
    return image * (1 - deep[..., None] ** 1.3 * FOLD)
