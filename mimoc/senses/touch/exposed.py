"""What several geoms of one body show to the outside: points spread over it, and carried over when they grow."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from mimoc.body import Geom
from mimoc.senses.touch.even_points import spread
from mimoc.senses.touch.surface import FloatArray, depth, outward, place

Layout = tuple[FloatArray, ...]
"""The points of each geom, as `place` takes them."""

HAIR = 1e-4
"""How far above its geom a point must be outside of the others, in half breadths: faces that meet do not show."""
CROWDED = 0.6
"""Where geoms meet, points closer to each other than this, in spacings, are one too many."""
BURIED_M = 1e-10
"""Depth from which on a point is inside."""
PARALLEL = 1e-12
"""Surfaces at less than this, in rad, have no seam to speak of."""
STEPS = 50
"""More than any body needs."""


def lay_out(geoms: Sequence[Geom], spacing_m: float) -> Layout:
    """Return points that are about a spacing apart on all that some geoms show."""
    layout: list[FloatArray] = []
    for index, geom in enumerate(geoms):
        multiples = spread(geom, spacing_m)
        for other in (*geoms[:index], *geoms[index + 1 :]):
            multiples = multiples[depth(other, place(geom, (1 + HAIR) * multiples)) <= 0]
        for other, theirs in zip(geoms, layout, strict=False):
            multiples = _without_crowd(geom, multiples, other, theirs, CROWDED * spacing_m)
        layout.append(multiples)
    return tuple(layout)


def carry_over(layout: Layout, geoms: Sequence[Geom]) -> FloatArray:
    """Return the points of a layout on geoms of other sizes, shape (n, 3), in the frame of their body.

    Each stays where it is on its geom. Where that is now inside another one, it moves to the nearest place outside.
    """
    points_m = np.concatenate([place(geom, multiples) for geom, multiples in zip(geoms, layout, strict=True)])
    for _ in range(STEPS):
        before_m = points_m.copy()
        for geom in geoms:
            buried = depth(geom, points_m) > BURIED_M
            points_m[buried] = _to_surface(geom, points_m[buried])
        for geom, other in permutations(geoms, 2):
            stuck = (np.abs(depth(geom, points_m)) < BURIED_M) & (depth(other, points_m) > BURIED_M)
            points_m[stuck] = _to_seam(geom, other, points_m[stuck])
        if np.array_equal(points_m, before_m):
            break
    return points_m


def _without_crowd(geom: Geom, multiples: FloatArray, other: Geom, theirs: FloatArray, distance_m: float) -> FloatArray:
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
    slopes = np.maximum(np.linalg.norm(along, axis=1), PARALLEL)
    steps_m = np.minimum(deep_m / slopes, np.sqrt(2 * min(geom.size_m[0], other.size_m[0]) * deep_m))
    return _to_surface(geom, points_m + (steps_m / slopes)[:, None] * along)
