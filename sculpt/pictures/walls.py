"""Textures of walls; the top of an image is the top of the wall."""

import numpy as np
from pictures.floors import star
from pictures.tiling import cells, grid, half_drop, lit, noise, paint, plain, tones

from mimoc.base.geometry.rotations import FloatArray


def plaster() -> FloatArray:
    """Return sponged plaster in a warm yellow."""
    image = plain((232, 196, 132), 0.04 * noise(201, 3, 3))
    return paint(image, (250, 234, 198), 0.05 - noise(202, 14, 14), 0.6)


def stripes() -> FloatArray:
    """Return broad and narrow stripes from top to bottom."""
    right, _ = grid()
    _, x = cells(right, 4)
    image = plain((246, 240, 226))
    image = paint(image, (132, 172, 184), np.abs(x) - 0.2, 0.03)
    return paint(image, (222, 158, 122), np.abs(np.abs(x) - 0.35) - 0.025, 0.03)


def dots() -> FloatArray:
    """Return dots of two colours."""
    x, y = half_drop(4)
    image = paint(plain((248, 238, 222)), (224, 108, 96), np.hypot(x, y) - 0.22, 0.03)
    return paint(image, (92, 148, 160), np.hypot(x, (y + 1) % 1 - 0.5) - 0.11, 0.03)


def stars() -> FloatArray:
    """Return dark stars on a light wall."""
    x, y = half_drop(4)
    return paint(plain((226, 230, 238)), (66, 84, 128), star(x, y, 0.3), 0.03)


def triangles() -> FloatArray:
    """Return triangles in three colours."""
    right, down = grid()
    row, y = cells(down, 4)
    column, x = cells((right + (row % 2) / 12) % 1, 6)
    height, half_width = y + 0.28, np.abs(x)
    outside = np.maximum(half_width - 0.55 * height, y - 0.3)
    colours = np.array([(232, 134, 92), (106, 158, 138), (238, 188, 86)], np.float64)
    motif = colours[((column + row) % 3).astype(np.intp)]
    cover = np.clip(0.5 - outside / 0.03, 0, 1)[..., None]
    return plain((246, 242, 232)) * (1 - cover) + motif * cover


def flowers() -> FloatArray:
    """Return pink flowers with two leaves each."""
    x, y = half_drop(4)
    image = plain((238, 240, 222))
    image = paint(image, (112, 154, 104), _leaf(x - 0.2, y - 0.27, 0.8), 0.03)
    image = paint(image, (112, 154, 104), _leaf(x + 0.2, y - 0.27, -0.8), 0.03)
    petals = np.hypot(x, y + 0.06) - 0.2 * (0.8 + 0.25 * np.cos(5 * np.arctan2(x, -(y + 0.06))))
    image = paint(image, (220, 112, 134), petals, 0.03)
    return paint(image, (250, 214, 110), np.hypot(x, y + 0.06) - 0.075, 0.03)


def leaves() -> FloatArray:
    """Return twigs of green leaves that climb the wall."""
    right, down = grid()
    column, x = cells(right, 4)
    shifted = (down + (column % 2) / 8) % 1
    _, y = cells(shifted, 4)
    sway = 0.08 * np.sin(2 * np.pi * 2 * shifted)
    stem, side = x - sway, np.abs(x - sway)
    image = plain((244, 240, 224))
    image = paint(image, (120, 138, 96), side - 0.022, 0.03)
    image = paint(image, (88, 136, 98), _leaf(side - 0.2, y + 0.1, -0.75), 0.04)
    return paint(image, (150, 182, 116), _leaf(stem - 0.17, y - 0.33, 0.75), 0.04)


def bricks() -> FloatArray:
    """Return bricks in half bond."""
    right, down = grid()
    row, y = cells(down, 8)
    column, x = cells((right + (row % 2) / 8) % 1, 4)
    tone = 0.14 * tones(261, row, column) + 0.08 * noise(262, 2.5, 2)
    image = plain((178, 92, 70), tone)
    joint = np.minimum(0.5 - np.abs(y), 2.2 * (0.5 - np.abs(x)))
    image = lit(image, 1 - 0.18 * ((joint < 0.17) & (y > 0)))
    return paint(image, (214, 200, 182), joint - 0.075, 0.05)


def wainscot() -> FloatArray:
    """Return panels up to a third of the wall's height, a ledge, and plain green above; a tile is as high as a wall."""
    right, down = grid()
    _, x = cells(right, 2)
    image = plain((164, 190, 160), 0.03 * noise(271, 6, 6))
    panelled = down > 0.64
    image = np.where(panelled[..., None], plain((240, 234, 220)), image)
    frame = np.maximum(np.abs(x) / 0.36, np.abs(down - 0.805) / 0.105)
    groove = panelled & (np.abs(frame - 1) < 0.055)
    image = lit(image, np.where(groove, np.where(down < 0.8, 0.7, 0.84), 1.0))
    image = paint(image, (252, 248, 238), np.abs(down - 0.645) - 0.014)
    image = paint(image, (150, 136, 116), np.abs(down - 0.664) - 0.004)
    image = paint(image, (206, 194, 172), 0.945 - down)
    return paint(image, (150, 136, 116), np.abs(down - 0.945) - 0.003)


def gingham() -> FloatArray:
    """Return woven squares, darkest where two stripes cross."""
    right, down = grid()
    _, x = cells(right, 8)
    _, y = cells(down, 8)
    across, along = (np.clip(0.5 - (np.abs(each) - 0.25) / 0.05, 0, 1) for each in (x, y))
    image = plain((250, 246, 238))
    return image + 0.5 * (across + along)[..., None] * (np.array((120.0, 146, 196)) - image)


def _leaf(x: FloatArray, y: FloatArray, turn: float) -> FloatArray:
    """Return the distance of each texel to a pointed leaf, which is upright at a rotation of 0 rad; negative inside."""
    along = -np.sin(turn) * x + np.cos(turn) * y
    aside = np.cos(turn) * x + np.sin(turn) * y
    return np.abs(aside) - 0.4 * (0.18 - np.minimum(along**2 / 0.18, 1))
