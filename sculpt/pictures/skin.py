"""The pictures of the skin: colours of skin and cloth by how rosy and how deep in a crease they are."""

import numpy as np
from pictures.cubes import SKIN, over
from pictures.inks import Painted, ink, mixed, plain, with_palette

from mimoc.base.geometry.rotations import FloatArray

SHADES = 256
"""Colours of skin and cloth."""
SHADES_PX = 32
"""Sides of the pictures of skin and cloth."""
DEEP = ink("shade")
"""Skin in a crease."""
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
