"""Bounds and volume of the convex collision shapes of toys."""

import math

import numpy as np

from mimoc.geometry import primitives
from mimoc.geometry.primitives import Extents, Kind, extents
from mimoc.geometry.rotations import FloatArray, matrix_from_quaternion
from mimoc.toys.model import Solid

_ANGLES = np.linspace(0, math.tau, 48, endpoint=False)
_AROUND = np.stack([np.cos(_ANGLES), np.sin(_ANGLES), np.zeros(48)], axis=1)
"""Horizontal directions."""


def bounds(solid: Solid) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of a solid's axis-aligned bounding box."""
    at, extent = np.array(solid.pos), _extents(solid).along(matrix_from_quaternion(solid.quat)[:, None])[:, 0]
    return at - extent, at + extent


def radius(solid: Solid) -> float:
    """Return the largest distance of a solid's points from the z axis."""
    at, axes = np.array(solid.pos), matrix_from_quaternion(solid.quat)
    if solid.mesh is not None:
        return float(np.linalg.norm((at + solid.mesh.vertices @ axes.T)[:, :2], axis=1).max())
    extent = _extents(solid).along((_AROUND @ axes)[:, None])[:, 0]
    return float((_AROUND @ at + extent).max()) / math.cos(math.pi / len(_AROUND))


def solid_volume(solid: Solid) -> float:
    """Return the volume of a solid."""
    return solid.mesh.volume if solid.mesh else primitives.volume(_kind(solid), solid.size)


def _extents(solid: Solid) -> Extents:
    """Return the extents of a single primitive."""
    return extents([(_kind(solid), solid.size)])


def _kind(solid: Solid) -> Kind:
    assert solid.type != "mesh"
    return solid.type
