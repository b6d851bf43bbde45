"""Primitive solids, sized as MuJoCo sizes them: volume, area, how far they reach, and the way out of them.

Sizes are the radius of a sphere, radius and half length of a capsule or cylinder along z, the half axes of an
ellipsoid and the half edges of a box, in any unit of length; a capsule's caps are not counted in its half length.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mimoc.base.geometry.rotations import FloatArray

PRECISION = 1e-14  # Relative change at which the search for the nearest point ends; Newton's steps double the digits.
MAX_STEPS = 60  # More than any ellipsoid needs: five to ten are usual.
MIN_COORDINATE = 1e-14
"""Least coordinate of a point along a half axis, relative to it, so that its nearest point is on one side."""
RINGS, SPOKES = 24, 48  # Nodes of the quadrature of an area: exact to twelve digits for half axes up to two to one.
QUADRATURE = np.polynomial.legendre.leggauss(RINGS)
"""The heights of Gauss' rings and their weights, shape (RINGS,) each."""


def ellipse_perimeter(half_axis: float, other: float) -> float:
    """Return the perimeter of an ellipse.

    Ramanujan's second formula (1914), whose relative error is 2.3e-5 h⁵ with h = ((a - b) / (a + b))²: 1e-13 for half
    axes of 1.3 to 1, which is a head's ratio, and 1e-10 for 2 to 1.
    """
    h = ((half_axis - other) / (half_axis + other)) ** 2
    return math.pi * (half_axis + other) * (1 + 3 * h / (10 + math.sqrt(4 - 3 * h)))


def ellipsoid_area(half_axes: Sequence[float]) -> float:
    """Return the area of an ellipsoid: the integral of its image on the unit sphere, by Gauss' quadrature."""
    heights, weights = QUADRATURE
    radii = np.sqrt(1 - heights**2)
    angles = 2 * math.pi * (np.arange(SPOKES) + 0.5) / SPOKES
    a, b, c = half_axes
    across = (radii[:, None] * np.cos(angles) / a) ** 2 + (radii[:, None] * np.sin(angles) / b) ** 2
    stretched = np.sqrt(across + (heights[:, None] / c) ** 2).mean(axis=1)
    return float(2 * math.pi * a * b * c * weights @ stretched)


def nearest_points(half_axes: Sequence[float], points: FloatArray) -> FloatArray:
    """Return the nearest points of the surface of an ellipsoid, shape (n, 3), from points inside or outside of it.

    A point x is nearest to p where it lies along the surface's normal from it: x_i (t + a_i²) = a_i² p_i, and t is
    such that x is on the surface. With u = t + min(a²) no digits are lost near the middle. One over the size of x in
    half axes is a concave function of u, so Newton's steps from below never pass the solution; the first guess is
    what it is for a sphere. Points are in the frame of the ellipsoid, shape (n, 3).
    """
    axes = np.array(half_axes, float)
    others = axes**2 - axes.min() ** 2
    scaled = np.maximum(np.abs(points) * axes, MIN_COORDINATE * axes**2)
    least = (scaled - others).max(axis=1)
    u = np.maximum(axes.min() ** 2 * np.sqrt(((points / axes) ** 2).sum(axis=1)), least)
    for _ in range(MAX_STEPS):
        across = u[:, None] + others
        squares = (scaled / across) ** 2
        square = squares.sum(axis=1)
        before = u
        u = np.maximum(u + square * (np.sqrt(square) - 1) / (squares / across).sum(axis=1), least)
        if (np.abs(u - before) <= PRECISION * u).all():
            break
    return np.copysign(axes * scaled / (u[:, None] + others), points)


def signed_depths(half_axes: Sequence[float], points: FloatArray) -> FloatArray:
    """Return the distance of points in its frame, shape (n, 3), from the surface, shape (n,): negative outside."""
    inside = ((points / half_axes) ** 2).sum(axis=1) < 1
    distances = np.linalg.norm(points - nearest_points(half_axes, points), axis=1)
    return np.where(inside, distances, -distances)


def normals(half_axes: Sequence[float], points: FloatArray) -> FloatArray:
    """Return the normal of the surface at the nearest point of each of some points, unit vectors, shape (n, 3)."""
    gradients = nearest_points(half_axes, points) / np.square(half_axes)
    return gradients / np.linalg.norm(gradients, axis=1, keepdims=True)


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

    half_edges: FloatArray  # Half edges of the boxes, shape (n, 3).
    half_axes: FloatArray  # Half axes of the ellipsoids, shape (n, 3).

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


_STEEPEST_RAD = math.pi / 2 - 1e-3
_GOLDEN = (math.sqrt(5) - 1) / 2
_ROUNDS = 50  # Each makes an interval .62 times as long: to ten digits.
DIRECTIONS = 360  # Directions in which a tape is taken to touch; the girth of a trunk is then exact to 1e-5.


@dataclass(frozen=True, slots=True)
class Solids:
    """Some primitives in their places."""

    extents: Extents  # How far each of the n primitives reaches from its centre.
    centres: FloatArray  # Shape (n, 3).
    rotations: FloatArray  # World from primitive, shape (n, 3, 3).

    def reaches(self, directions: FloatArray) -> FloatArray:
        """Return how far each reaches from the origin along vectors (..., n, 3), times their length, (..., n)."""
        local = np.einsum("nij,...ni->...nj", self.rotations, directions)
        return (directions * self.centres).sum(axis=-1) + self.extents.along(local)

    def span(self, direction: FloatArray) -> tuple[float, float]:
        """Return the least and the largest reach of all along a unit vector, shape (3,)."""
        towards = self._all(direction)
        return -float(self.reaches(-towards).max()), float(self.reaches(towards).max())

    def section_reach(self, normal: FloatArray, offset: float, directions: FloatArray) -> FloatArray:
        """Return how far the section with a plane reaches from the origin in directions within the plane, shape (m,).

        A point of the plane at x has normal @ x = offset. The section of a convex solid reaches as far as the least of
        all half-spaces that hold the solid, tilted about lines in the plane; solids that the plane misses do not count.

        Args:
            normal: Unit vector, shape (3,).
            offset: Of the plane from the origin.
            directions: Unit vectors, orthogonal to the normal, shape (m, 3).
        """
        low_m = -self.reaches(-self._all(normal))
        high_m = self.reaches(self._all(normal))
        met = (low_m < offset) & (offset < high_m)
        return np.where(met, self._least_half_space(normal, offset, directions), -np.inf).max(axis=1)

    def girth(self, normal: FloatArray, offset: float) -> float:
        """Return the length of a tape around the section with a plane, which spans hollows (Cauchy's formula)."""
        angle_rad = np.arange(DIRECTIONS) * (2 * math.pi / DIRECTIONS)
        first = np.linalg.svd(normal[None])[2][1]
        second = np.cross(normal, first)
        around = np.cos(angle_rad)[:, None] * first + np.sin(angle_rad)[:, None] * second
        return float(2 * math.pi * self.section_reach(normal, offset, around).mean())

    def _all(self, vector: FloatArray) -> FloatArray:
        return np.broadcast_to(vector, self.centres.shape)

    def _least_half_space(self, normal: FloatArray, offset: float, directions: FloatArray) -> FloatArray:
        """Return the least reach over all tilts of a half-space out of the plane, shape (m, n), by golden section."""

        def reach(tilt_rad: FloatArray) -> FloatArray:
            slope = np.tan(tilt_rad)
            return self.reaches(directions[:, None] + slope[..., None] * normal) - slope * offset

        shape = (len(directions), len(self.centres))
        low = np.full(shape, -_STEEPEST_RAD)
        high = np.full(shape, _STEEPEST_RAD)
        for _ in range(_ROUNDS):
            left = high - _GOLDEN * (high - low)
            right = low + _GOLDEN * (high - low)
            lower = reach(left) < reach(right)
            low, high = np.where(lower, low, left), np.where(lower, right, high)
        return reach((low + high) / 2)
