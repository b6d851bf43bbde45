"""Primitive solids, sized as MuJoCo sizes them: volume, area, how far they reach, and the way out of them.

Sizes are the radius of a sphere, radius and half length of a capsule or cylinder along z, the half axes of an
ellipsoid and the half edges of a box, in any unit of length; a capsule's caps are not counted in its half length.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mimoc.base.geometry.ellipsoids import ellipse_perimeter, ellipsoid_area, normals, signed_depths
from mimoc.base.geometry.rotations import FloatArray

Kind = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box"]
Size = Sequence[float]


def volume(kind: Kind, size: Size) -> float:
    """Return the volume of a primitive."""
    match kind:
        case "box":
            return 8 * size[0] * size[1] * size[2]
        case "sphere":
            return 4 / 3 * math.pi * size[0] ** 3
        case "ellipsoid":
            return 4 / 3 * math.pi * size[0] * size[1] * size[2]
        case "cylinder":
            return math.pi * size[0] ** 2 * 2 * size[1]
        case "capsule":
            return math.pi * size[0] ** 2 * 2 * size[1] + 4 / 3 * math.pi * size[0] ** 3


def area(kind: Kind, size: Size) -> float:
    """Return the area of the whole surface of a primitive."""
    match kind:
        case "box":
            return 8 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0])
        case "sphere":
            return 4 * math.pi * size[0] ** 2
        case "ellipsoid":
            return ellipsoid_area(size)
        case "cylinder":
            return 2 * math.pi * size[0] * (2 * size[1] + size[0])
        case "capsule":
            return 4 * math.pi * size[0] * (size[1] + size[0])


def girth(kind: Kind, size: Size) -> float:
    """Return the perimeter of a primitive's section across z, through its middle."""
    if kind == "box":
        return 4 * (size[0] + size[1])
    return ellipse_perimeter(size[0], size[1]) if kind == "ellipsoid" else 2 * math.pi * size[0]


@dataclass(frozen=True, slots=True)
class Extents:
    """How far n primitives reach from their centres: each is the sum of a box and an ellipsoid (Minkowski)."""

    half_edges: FloatArray
    """Of the boxes, shape (n, 3)."""
    half_axes: FloatArray
    """Of the ellipsoids, shape (n, 3)."""

    def along(self, directions: FloatArray) -> FloatArray:
        """Return how far each reaches along unit vectors of its own frame (..., n, 3), shape (..., n): its support."""
        by_edges = np.einsum("...i,...i->...", np.abs(directions), self.half_edges)
        by_axes = directions * self.half_axes
        return by_edges + np.sqrt(np.einsum("...i,...i->...", by_axes, by_axes))

    def farthest(self, directions: FloatArray) -> FloatArray:
        """Return the point of each farthest along unit vectors of its own frame (..., n, 3), shape (..., n, 3)."""
        by_axes = directions * self.half_axes
        lengths = np.linalg.norm(by_axes, axis=-1, keepdims=True)
        round_off = np.where(lengths > 0, lengths, 1.0)
        return np.sign(directions) * self.half_edges + by_axes * self.half_axes / round_off


def extents(primitives: Iterable[tuple[Kind, Size]]) -> Extents:
    """Return how far some primitives reach, from kind and size of each."""
    edges, axes = zip(*(_box_and_ellipsoid(kind, size) for kind, size in primitives), strict=True)
    return Extents(np.array(edges, float), np.array(axes, float))


def depths(kind: Kind, size: Size, points: FloatArray) -> FloatArray:
    """Return how deep inside of a primitive points are, shape (n,); outside it is negative, and at most the distance.

    Points are in the frame of the primitive, shape (n, 3).
    """
    if kind == "box":
        x, y, z = (size - np.abs(points)).T
        return np.minimum(np.minimum(x, y), z)
    if kind == "cylinder":
        return np.minimum(*_depths_in_cylinder(points, size).T)
    if kind == "ellipsoid":
        return signed_depths(size, points)
    return size[0] - np.linalg.norm(_from_axis(kind, size, points), axis=1)


def outward(kind: Kind, size: Size, points: FloatArray) -> FloatArray:
    """Return the directions from points inside of a primitive to the nearest points of its surface, shape (n, 3).

    Points are in the frame of the primitive, shape (n, 3).
    """
    if kind == "box":
        nearest = (size - np.abs(points)).argmin(axis=1)
        return np.where(np.arange(3) == nearest[:, None], np.copysign(1.0, points), 0.0)
    if kind == "cylinder":
        by_side, by_end = _depths_in_cylinder(points, size).T
        ends = np.copysign((0.0, 0.0, 1.0), points)
        return np.where((by_end < by_side)[:, None], ends, _unit(points * (1, 1, 0)))
    if kind == "ellipsoid":
        return normals(size, points)
    return _unit(_from_axis(kind, size, points))


def _box_and_ellipsoid(kind: Kind, size: Size) -> tuple[Size, Size]:
    none = (0.0, 0.0, 0.0)
    match kind:
        case "box":
            return size, none
        case "ellipsoid":
            return none, size
        case "sphere":
            return none, (size[0], size[0], size[0])
        case "capsule":
            return (0.0, 0.0, size[1]), (size[0], size[0], size[0])
        case "cylinder":
            return (0.0, 0.0, size[1]), (size[0], size[0], 0.0)


def _from_axis(kind: Kind, size: Size, points: FloatArray) -> FloatArray:
    """Return the vectors from the nearest points of a capsule's axis, or from a sphere's centre."""
    half = size[1] if kind == "capsule" else 0.0
    vectors = points.copy()
    vectors[:, 2] -= np.clip(points[:, 2], -half, half)
    return vectors


def _depths_in_cylinder(points: FloatArray, size: Size) -> FloatArray:
    """Return how far the round side and the nearer end are from points inside, shape (n, 2)."""
    return np.column_stack((size[0] - np.hypot(points[:, 0], points[:, 1]), size[1] - np.abs(points[:, 2])))


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 0, vectors, (1.0, 0.0, 0.0)) / np.where(lengths > 0, lengths, 1.0)
