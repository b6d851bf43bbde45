"""Where each direction from the middle of a head is in the picture of its face."""

import numpy as np

from mimoc.base.geometry.rotations import FloatArray

POLE_DEG = -16.0
"""Elevation of the direction in the middle of the picture, below the eyes; the picture ends opposite, in the hair."""
NEAR_RAD = np.radians(60.0)
"""Within about this angle of the middle the picture is even; what is behind, under hair, is smaller and smaller."""


def unwrapped(directions: FloatArray) -> FloatArray:
    """Return the places of directions in the picture, from its lower left, 0 to 1, shape (n, 2).

    Args:
        directions: From the middle of the head, in its half axes: x forward, y left, z up; shape (n, 3).
    """
    along = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    middle, right, up = _axes()
    far = np.arccos(np.clip(along @ middle, -1, 1))
    x, y = along @ right, along @ up
    across = np.maximum(np.hypot(x, y), 1e-12)
    radius = 0.5 * np.tanh(far / NEAR_RAD) / np.tanh(np.pi / NEAR_RAD)
    return np.stack((0.5 + radius * x / across, 0.5 + radius * y / across), axis=-1)


def wrapped(places: FloatArray) -> FloatArray:
    """Return the directions that places in the picture show, unit vectors, shape (..., 3); beyond its edge, the edge's.

    Args:
        places: From the lower left, 0 to 1, shape (..., 2).
    """
    x, y = places[..., 0] - 0.5, places[..., 1] - 0.5
    radius = np.hypot(x, y)
    angle = NEAR_RAD * np.arctanh(np.minimum(2 * radius, 1) * np.tanh(np.pi / NEAR_RAD))
    middle, right, up = _axes()
    share = np.sin(angle) / np.maximum(radius, 1e-12)
    return np.cos(angle)[..., None] * middle + (share * x)[..., None] * right + (share * y)[..., None] * up


def _axes() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the direction in the middle of the picture, and those to its right and its top, for one who faces it."""
    pole = np.radians(POLE_DEG)
    middle = np.array((np.cos(pole), 0.0, np.sin(pole)))
    right = np.array((0.0, 1.0, 0.0))
    return middle, right, np.cross(middle, right)
