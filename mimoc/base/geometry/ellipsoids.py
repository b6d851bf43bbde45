"""Ellipses and ellipsoids: perimeter, area, and the nearest point of the surface."""

import math
from collections.abc import Sequence

import numpy as np

from mimoc.base.geometry.rotations import FloatArray

PRECISION = 1e-14
"""Relative change at which the search for the nearest point ends; Newton's steps double the digits."""
MAX_STEPS = 60
"""More than any ellipsoid needs: five to ten are usual."""
SMALLEST = 1e-14
"""Least coordinate of a point along a half axis, relative to it, so that its nearest point is on one side."""
RINGS, SPOKES = 24, 48
"""Nodes of the quadrature of an area: exact to twelve digits for half axes up to two to one."""
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
    radii, angles = np.sqrt(1 - heights**2), 2 * math.pi * (np.arange(SPOKES) + 0.5) / SPOKES
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
    scaled = np.maximum(np.abs(points) * axes, SMALLEST * axes**2)
    least = (scaled - others).max(axis=1)
    u = np.maximum(axes.min() ** 2 * np.sqrt(((points / axes) ** 2).sum(axis=1)), least)
    for _ in range(MAX_STEPS):
        across = u[:, None] + others
        squares = (scaled / across) ** 2
        square = squares.sum(axis=1)
        before, u = u, np.maximum(u + square * (np.sqrt(square) - 1) / (squares / across).sum(axis=1), least)
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
