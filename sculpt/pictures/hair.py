"""The picture of hair: strokes, of which there are the more the higher; at the bottom is skin."""

import numpy as np
from pictures.cubes import SKIN, over
from pictures.inks import Painted, ink, mixed, plain, with_palette

WIDTH_PX, HEIGHT_PX = 512, 96
STROKES = 4200
SEED = 7
COLOURS = 16
FIRST = 0.16
"""Height at which the lowest strokes end: that of `CLEAR` in `mimoc.compiler.looks.skin.head`, within its margins."""
GROUND = 0.78
"""How much the skin between strokes is coloured at the top."""


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
