"""Textures of ceilings."""

import numpy as np
from pictures.tiling import cells, grid, half_drop, lit, noise, paint, plain

from mimoc.base.geometry.rotations import FloatArray


def plaster() -> FloatArray:
    """Return white plaster with the marks of a trowel."""
    return plain((238, 235, 226), 0.07 * noise(101, 24, 9) + 0.02 * noise(102, 2, 2))


def boards() -> FloatArray:
    """Return boards painted white, with a shadow in each groove."""
    right, _ = grid()
    _, x = cells(right, 6)
    image = plain((236, 232, 220), 0.035 * noise(111, 1, 26))
    image = paint(image, (214, 208, 194), 0.40 - x, 0.06)
    return paint(image, (160, 152, 138), 0.455 - np.abs(x), 0.05)


def panels() -> FloatArray:
    """Return square coffers, lit from one side."""
    right, down = grid()
    _, x = cells(right, 2)
    _, y = cells(down, 2)
    square = np.maximum(np.abs(x), np.abs(y))
    bevel = (square > 0.32) & (square < 0.38)
    light = np.where(np.abs(x) > np.abs(y), np.sign(x), np.sign(y))
    image = plain((240, 236, 226), 0.02 * noise(121, 8, 8))
    image = paint(image, (226, 218, 200), square - 0.32, 0.015)
    image = lit(image, 1 - bevel * (0.10 + 0.09 * light))
    return paint(image, (178, 168, 150), 0.488 - square, 0.015)


def clouds() -> FloatArray:
    """Return a pale sky."""
    thick = 0.8 * noise(131, 44, 26) + 0.2 * noise(132, 12, 7)
    image = plain((150, 196, 228))
    return paint(image, (246, 247, 244), 0.08 - thick, 0.5)


def golden_stars() -> FloatArray:
    """Return stars on a blue sky."""
    x, y = half_drop(2)
    image = plain((126, 148, 190), 0.05 * noise(141, 18, 18))
    image = paint(image, (250, 226, 150), star(x, y, 0.2), 0.02)
    return paint(image, (236, 238, 240), star(x, (y + 1) % 1 - 0.5, 0.1), 0.02)


def star(x: FloatArray, y: FloatArray, radius: float) -> FloatArray:
    """Return the distance of each texel to a five-pointed star that stands on two points; negative inside."""
    angle = np.arctan2(x, -y)
    sector = np.pi / 5
    folded = np.abs((angle + sector) % (2 * sector) - sector)
    distance = np.hypot(x, y)
    # The edge runs straight from a point at `radius` to an inner corner at 0.42 of it, in the folded sector.
    along, aside = distance * np.cos(folded), distance * np.sin(folded)
    inner_along, inner_aside = 0.42 * radius * np.cos(sector), 0.42 * radius * np.sin(sector)
    edge = np.hypot(radius - inner_along, inner_aside)
    return ((along - radius) * inner_aside + aside * (radius - inner_along)) / edge
