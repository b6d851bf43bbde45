"""Points on the exposed surface of a body of several geoms, and how they move when the geoms grow."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from mimoc.body import Geom
from mimoc.senses.touch.even_points import even_points
from mimoc.senses.touch.surface import FloatArray, depth, outward, place

Layout = tuple[FloatArray, ...]
"""The points of each geom, as `place` takes them."""

CLEARANCE = 1e-4
"""Height above its geom, relative to the geom's half breadth, at which a point must be outside of all other geoms: so
faces that coincide have no points."""
MIN_DISTANCE = 0.6
"""Least distance of points of different geoms, in spacings; one of two closer points is left out."""
DEPTH_TOLERANCE_M = 1e-10
"""A point deeper than this is inside a geom."""
MIN_SLOPE = 1e-12
"""Least angle of two surfaces in rad, so that a division by it is safe."""
MAX_STEPS = 50
"""More than any body needs."""


def lay_out(geoms: Sequence[Geom], spacing_m: float) -> Layout:
    """Return points about a spacing apart on the surface of some geoms where no other geom covers it."""
    layout: list[FloatArray] = []
    for index, geom in enumerate(geoms):
        multiples = even_points(geom, spacing_m)
        for other in (*geoms[:index], *geoms[index + 1 :]):
            multiples = multiples[depth(other, place(geom, (1 + CLEARANCE) * multiples)) <= 0]
        for other, theirs in zip(geoms, layout, strict=False):
            multiples = _without_close(geom, multiples, other, theirs, MIN_DISTANCE * spacing_m)
        layout.append(multiples)
    return tuple(layout)


def move_with_geoms(layout: Layout, geoms: Sequence[Geom]) -> FloatArray:
    """Return the points of a layout on geoms of other sizes, shape (n, 3), in the frame of their body.

    Each stays where it is on its geom; where that is now inside another geom, it moves to the nearest place outside.
    """
    points_m = np.concatenate([place(geom, multiples) for geom, multiples in zip(geoms, layout, strict=True)])
    inside = np.logical_or.reduce([depth(geom, points_m) > DEPTH_TOLERANCE_M for geom in geoms])
    moving = np.flatnonzero(inside)  # All others stay where they are.
    for _ in range(MAX_STEPS):
        if not moving.size:
            break
        before_m = points_m[moving]
        points_m[moving] = after_m = _moved(before_m, geoms)
        moving = moving[(after_m != before_m).any(axis=1)]
    return points_m


def _moved(points_m: FloatArray, geoms: Sequence[Geom]) -> FloatArray:
    """Return points moved once out of each geom that they are in, then along each to where they leave the others."""
    points_m = points_m.copy()
    for geom in geoms:
        inside = depth(geom, points_m) > DEPTH_TOLERANCE_M
        if inside.any():
            points_m[inside] = _to_surface(geom, points_m[inside])
    for geom, other in permutations(geoms, 2):
        covered = (np.abs(depth(geom, points_m)) < DEPTH_TOLERANCE_M) & (depth(other, points_m) > DEPTH_TOLERANCE_M)
        if covered.any():
            points_m[covered] = _to_seam(geom, other, points_m[covered])
    return points_m


def _without_close(geom: Geom, multiples: FloatArray, other: Geom, theirs: FloatArray, distance_m: float) -> FloatArray:
    """Return those points of a geom that are at least a distance from those of another one."""
    points_m, others_m = place(geom, multiples), place(other, theirs)
    near = np.flatnonzero(depth(other, points_m) > -distance_m)
    others_m = others_m[depth(geom, others_m) > -distance_m]
    gaps_m = np.linalg.norm(points_m[near, None] - others_m, axis=2)
    return np.delete(multiples, near[(gaps_m < distance_m).any(axis=1)], axis=0)


def _to_surface(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the nearest points of a geom's surface."""
    return points_m + depth(geom, points_m)[:, None] * outward(geom, points_m)


def _to_seam(geom: Geom, other: Geom, points_m: FloatArray) -> FloatArray:
    """Return points that are moved along a geom's surface to where they leave another geom, but for a second order.

    Moving each straight out of the other would send it to and fro between the two where these nearly touch. There,
    between balls of radius r, what is d deep is no further than the root of 2 r d from the seam.
    """
    normals, exits, deep_m = outward(geom, points_m), outward(other, points_m), depth(other, points_m)
    along = exits - (exits * normals).sum(axis=1, keepdims=True) * normals
    slopes = np.maximum(np.linalg.norm(along, axis=1), MIN_SLOPE)
    steps_m = np.minimum(deep_m / slopes, np.sqrt(2 * min(geom.size_m[0], other.size_m[0]) * deep_m))
    return _to_surface(geom, points_m + (steps_m / slopes)[:, None] * along)
