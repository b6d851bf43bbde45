"""The pictures of the skin: faces, and colours of skin and cloth by how rosy and how deep in a crease they are."""

import numpy as np
from pictures.cubes import HAIR, SHIRT, SKIN, STRIPE, blob, blush, brow, mouth, over, within
from pictures.expressions import FACES
from pictures.inks import Painted, ink, mixed, plain, with_palette
from uv_map import wrapped

from mimoc.geometry.rotations import FloatArray

FACE_PX = 256
"""Sides of the picture of a face."""
COLOURS, SHADES = 128, 256
"""Of a face, and of skin and cloth."""
SHADES_PX = 32
"""Sides of the pictures of skin and cloth."""
DEEP = ink("shade")
"""Skin in a crease."""
ROSY = mixed(blush=0.85, skin=0.15)
LASH = ink("lash")
RIM = mixed(lip=0.6, skin=0.4)
"""The rims of the lids."""
EYE_Y, EYE_Z = 0.322, -0.083
"""Middle of an eye in the frontal view, in head radii, of a head of a child's breadth."""
BREADTH = 0.863
"""Half of the breadth of the head that the faces are drawn for, in head radii: the skin stretches them on others."""


def paint_face(expression: str) -> Painted:
    """Return the skin of the head with an expression, a key of `FACES`; see `uv_map`."""
    face, (x, y, z), image = FACES[expression], _directions(), _bare_head()
    rows, columns = np.nonzero((x > 0.3) & (z < 0.5) & (np.abs(y) < 0.75))
    part = np.s_[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    front, across, height = np.where(x[part] > 0, 1.0, 0.0), BREADTH * y[part], z[part]
    drawn = brow(image[part], np.abs(across), height, front, face)
    image[part] = mouth(drawn, across, height, front, face)
    return with_palette(image, COLOURS)


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


def _directions() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the direction that each texel of a face shows, in half axes of the head."""
    steps = (np.arange(FACE_PX, dtype=np.float64) + 0.5) / FACE_PX
    right, up = np.meshgrid(steps, steps[::-1])
    x, y, z = np.moveaxis(wrapped(np.stack((right, up), axis=-1)), 2, 0)
    return x, y, z


def _thin_hair(image: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Draw even hair whose ends are strands: strands all over would double the size of the picture."""
    whorl_x, whorl_z = -0.8, 0.6
    angle = np.arccos(np.clip(whorl_x * x + whorl_z * z, -1, 1))
    strands = np.sin(23 * np.arctan2(np.abs(y), whorl_z * x - whorl_x * z) + 3 * angle)
    return over(image, HAIR, 0.55 * within(angle - (1.27 + 0.03 * strands), 0.60))


def _bare_head() -> FloatArray:
    """Return what all expressions share: skin, hair, and the lids' rims."""
    x, y, z = _directions()
    front, across = np.where(x > 0, 1.0, 0.0), BREADTH * y
    image = blush(plain(x.shape, SKIN), across, z, front)
    image = over(image, DEEP, 0.30 * blob(np.abs(y) - 1.0, z + 0.16, 0.06, 0.12) * (np.abs(x) < 0.25))
    image = _thin_hair(image, x, y, z)
    side, up = (np.abs(across) - EYE_Y) / 0.142, (z - EYE_Z) / 0.092
    image = over(image, RIM, 0.40 * front * blob(side, up, 1.3, 1.5))
    lashes = np.hypot(side, up) - 1.06
    return over(image, LASH, 0.75 * front * np.clip(0.15 + 1.2 * up, 0, 1) * within(np.abs(lashes) - 0.07, 0.14))
