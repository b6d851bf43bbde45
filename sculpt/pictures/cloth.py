"""The pictures of cloth: a pattern, a knitted band along the hems, and shades by how deep in a fold it is.

A picture has two garments, one above the other: the upper half of each is its band, the lower its pattern.
"""

from collections.abc import Mapping

import numpy as np
from pictures.cubes import over, within
from pictures.inks import Painted, ink, plain, with_palette

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.colours import FOLDED, INKS

ROWS_PX, COLUMNS_PX = 128, 32
"""Height and width of a picture."""
PLACES: Mapping[str, int] = {"bodysuit": 0, "shirt": 1, "nappy": 0, "trousers": 1}
"""Which garment of its picture each is, from the bottom."""
BANDS: Mapping[str, float] = {"bodysuit": 5.0, "shirt": 7.0, "nappy": 7.0, "trousers": 8.0}
"""Breadth of the band along a hem, [mm]."""
SEEN = 2.2
"""Distance from a hem, in breadths of its band, up to which a place in the picture tells it."""
HIGH, MIDDLE, LOW = 0.96, 0.5, 0.06
"""Places at the hem, far from it, and deep in a fold, as shares of a garment's part of the picture."""
SHADES = 256
"""Colours of a picture."""


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


def paint_top() -> Painted:
    """Return the colours of a shirt with stripes, and of a bodysuit below it."""
    across, _ = _places()
    stripes = within(0.25 - np.cos(2 * np.pi * across), 0.5)
    suit = plain(across.shape, ink("shirt"))
    return with_palette(np.vstack([_shaded(top, "band") for top in (over(suit, ink("stripe"), stripes), suit)]), SHADES)


def paint_bottom() -> Painted:
    """Return the colours of trousers, and of a nappy below them."""
    bottom = _shaded(plain(_places()[0].shape, ink("trousers")), "trousers_band")
    return with_palette(np.vstack((bottom, bottom)), SHADES)


def _places() -> tuple[FloatArray, FloatArray]:
    """Return how far each texel of a garment is to the right, and its height, 0 to 1."""
    right = (np.arange(COLUMNS_PX, dtype=np.float64) + 0.5) / COLUMNS_PX
    up = 1 - (np.arange(ROWS_PX // 2, dtype=np.float64) + 0.5) / (ROWS_PX // 2)
    across, height = np.meshgrid(right, up)
    return across, height


def _shaded(cloth: FloatArray, band: str) -> FloatArray:
    """Return a garment with a band of an ink, and darker in folds."""
    _, height = _places()
    edge = HIGH - (HIGH - MIDDLE) / SEEN
    flat = over(cloth, ink(band), np.clip((height - edge) * (ROWS_PX // 2) + 0.5, 0, 1))
    deep = np.clip((MIDDLE - height) / (MIDDLE - LOW), 0, 1)
    return flat + deep[..., None] ** 1.3 * (_folded(flat) - flat)


def _folded(flat: FloatArray) -> FloatArray:
    """Return a canvas of cloth as it is in a fold."""
    fold = np.zeros_like(flat)
    for number, name in enumerate(INKS):
        if name + FOLDED in INKS:
            fold[..., INKS.index(name + FOLDED)] = flat[..., number]
    return fold
