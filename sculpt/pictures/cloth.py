"""The pictures of cloth: a pattern, a knitted band along the hems, and shades by how deep in a fold it is.

A picture has two garments, one above the other: the upper half of each is its band, the lower its pattern.
"""

from collections.abc import Mapping

import numpy as np
from pictures.cubes import SKIN, over, within
from pictures.inks import Painted, ink, mixed, plain, with_palette

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.pictures import FOLDED, INKS

ROWS_PX, COLUMNS_PX = 128, 32  # Height and width of a picture.
PLACES: Mapping[str, int] = {"bodysuit": 0, "shirt": 1, "nappy": 0, "trousers": 1}
"""Which garment of its picture each is, from the bottom."""
BANDS: Mapping[str, float] = {"bodysuit": 5.0, "shirt": 7.0, "nappy": 7.0, "trousers": 8.0}
"""Breadth of the band along a hem, [mm]."""
SEEN = 2.2  # Distance from a hem, in breadths of its band, up to which a place in the picture tells it.
HIGH, MIDDLE, LOW = 0.96, 0.5, 0.06
"""Places at the hem, far from it, and deep in a fold, as shares of a garment's part of the picture."""
SHADES = 256  # Colours of a picture.


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


SHADES_PX = 32  # Sides of the pictures of skin and cloth.
DEEP = ink("shade")  # Skin in a crease.
ROSY = mixed(blush=0.85, skin=0.15)


def paint_skin() -> Painted:
    """Return the colours of skin: rosier to the right, deeper in a crease to the bottom."""
    rosy, deep = _shades()
    image = over(over(plain(rosy.shape, SKIN), ROSY, 0.75 * rosy), DEEP, 0.72 * deep**1.4)
    return with_palette(image, SHADES)


def _shades() -> tuple[FloatArray, FloatArray]:
    """Return how far each texel of a small picture is to the right and to the bottom, 0 to 1."""
    steps = (np.arange(SHADES_PX, dtype=np.float64) + 0.5) / SHADES_PX
    right, down = np.meshgrid(steps, steps)
    return right, down


WIDTH_PX, HEIGHT_PX = 512, 96
STROKES = 4200
SEED = 7
COLOURS = 16
FIRST = 0.16
"""Height at which the lowest strokes end: that of `CLEAR` in `mimoc.compiler.looks.head`, within its margins."""
GROUND = 0.78  # How much the skin between strokes is coloured at the top.


def paint_hair() -> Painted:
    """Return strokes of hair along the columns, from skin at the bottom to dense hair at the top."""
    rng = np.random.default_rng(SEED)
    up = (HEIGHT_PX - 0.5 - np.arange(HEIGHT_PX)) / HEIGHT_PX
    columns = np.arange(WIDTH_PX)
    image = plain((HEIGHT_PX, WIDTH_PX), SKIN)
    rise = np.clip((up - FIRST) / (0.75 - FIRST), 0, 1)
    image = over(image, ink("hair"), np.repeat((GROUND * rise**1.15)[:, None], WIDTH_PX, axis=1))
    tones = (ink("hair"), ink("hair_dark"), mixed(hair=0.5, hair_light=0.5), mixed(hair=0.6, hair_dark=0.4))
    for _ in range(STROKES):
        middle, width = rng.uniform(0, WIDTH_PX), rng.uniform(0.35, 0.75)
        low, tone = FIRST + (1.05 - FIRST) * rng.uniform() ** 1.15, tones[rng.integers(len(tones))]
        strength, lean = rng.uniform(0.25, 0.7) * min(1.0, 0.22 + low), rng.uniform(-4, 4)
        away = (columns[None] - middle - lean * (up[:, None] - low) + WIDTH_PX / 2) % WIDTH_PX - WIDTH_PX / 2
        length = rng.uniform(0.12, 0.42)
        along = np.clip((up - low) / 0.10, 0, 1) * np.clip((low + length - up) / 0.12, 0, 1)
        image = over(image, tone, strength * along[:, None] * np.clip(1.2 - np.abs(away) / width, 0, 1))
    return with_palette(image, COLOURS)
