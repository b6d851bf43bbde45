"""The pictures of the skin: colours of skin and cloth by how rosy and how deep in a crease they are."""

import numpy as np
from pictures.cubes import SHIRT, SKIN, STRIPE, over, within
from pictures.inks import Painted, ink, mixed, plain, with_palette

from mimoc.geometry.rotations import FloatArray

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


def paint_shirt() -> Painted:
    """Return the colours of a shirt: one light and one dark stripe across, deeper in a fold to the bottom."""
    across, deep = _shades()
    stripe = within(0.25 - np.cos(2 * np.pi * across), 0.5)
    flat = over(plain(across.shape, SHIRT), STRIPE, stripe)
    fold = over(plain(across.shape, ink("shirt_fold")), ink("stripe_fold"), stripe)
    return with_palette(flat + (deep**1.3)[..., None] * (fold - flat), SHADES)


def paint_trousers() -> Painted:
    """Return the colours of trousers: deeper in a fold to the bottom."""
    _, deep = _shades()
    return with_palette(over(plain(deep.shape, ink("trousers")), ink("trousers_fold"), deep**1.3), SHADES)


def _shades() -> tuple[FloatArray, FloatArray]:
    """Return how far each texel of a small picture is to the right and to the bottom, 0 to 1."""
    steps = (np.arange(SHADES_PX, dtype=np.float64) + 0.5) / SHADES_PX
    right, down = np.meshgrid(steps, steps)
    return right, down
