"""The skin points of a body: where it senses touch."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from mimoc.body import Body, BodyTree, Geom, assemble, grow_average
from mimoc.body.reference import REFERENCE_AGE_MONTHS
from mimoc.geometry.primitives import area
from mimoc.schema.composition import on_recompose
from mimoc.schema.names import Development, single_groups
from mimoc.senses.touch.exposed import Layout, lay_out, move_with_geoms
from mimoc.senses.touch.surface import FloatArray

PUPIL = np.array([[1.0, 0.0, 0.0, 0.0]])
"""The one point of an eye, at its front."""

DECIMALS = 12
"""Of coordinates in m: few enough not to depend on the order of sums, and a point is still on its surface."""


@dataclass(frozen=True, slots=True)
class SkinPoints:
    """Points on the surface of each body."""

    points_m: Mapping[str, FloatArray]
    """By body, in the order of the model, shape (n, 3), in the frame of the body."""
    spacing_m: Mapping[str, float]
    """Distance of neighbours by body."""


@dataclass(frozen=True, slots=True)
class _Patch:
    """The skin of one body of the average child of 18 months."""

    layout: Layout
    spacing_m: float
    area_m2: float
    """Of the body's geoms, including where they cover each other."""


def skin_points(tree: BodyTree, density: float, regions: Collection[str] | None = None) -> SkinPoints:
    """Return the skin points of a grown body.

    They are distributed over the average child of 18 months, and move with the geoms that they are on, so all infants
    have the same ones. As a body grows, the distance of its points grows with the root of its area, and so does what
    counts as their spacing: a contact is shared by the same number of points at every age.

    Args:
        tree: The body.
        density: Number of points, relative to what two-point discrimination asks for.
        regions: The groups of muscles whose parts have skin; None is all.
    """
    patches = _patches(tree.hands, tree.extra, tree.development, density)
    groups, covered = tree.body_groups, None if regions is None else single_groups(regions)
    points_m, spacing_m, moved_m = {}, {}, dict[Any, FloatArray]()
    for body in tree.bodies:
        if covered is not None and groups[body.name] not in covered:
            continue
        parts = (body.name, *(part for part, home in tree.merged if home == body.name))
        patch = _joined([patches[part.removeprefix("left_").removeprefix("right_")] for part in parts])
        points_m[body.name] = _points(body, patch.layout, moved_m)
        spacing_m[body.name] = patch.spacing_m * math.sqrt(_area_m2(body) / patch.area_m2)
    return SkinPoints(points_m, spacing_m)


@lru_cache(maxsize=8)
def _patches(hands: str, extra: tuple[str, ...], development: Development, density: float) -> Mapping[str, _Patch]:
    """Return the skin of the midline and of the right side, by body without its side."""
    tree = grow_average(REFERENCE_AGE_MONTHS, assemble(hands, False, development, extra))
    bodies = [body for body in tree.bodies if not body.name.startswith("left_")]
    return MappingProxyType({body.name.removeprefix("right_"): _patch(body, density) for body in bodies})


on_recompose(_patches.cache_clear)  # Others' parts may be replaced.


def _patch(body: Body, density: float) -> _Patch:
    area_m2 = _area_m2(body)
    if body.skin_spacing_m is None:
        return _Patch((PUPIL,), math.sqrt(area_m2), area_m2)
    spacing_m = body.skin_spacing_m / math.sqrt(density)
    return _Patch(lay_out(body.geoms, spacing_m), spacing_m, area_m2)


def _joined(patches: Sequence[_Patch]) -> _Patch:
    """Return the skin of parts that are joined rigidly, in the order of their geoms; each keeps its points."""
    layout = tuple(geom for patch in patches for geom in patch.layout)
    return _Patch(layout, patches[0].spacing_m, math.fsum(patch.area_m2 for patch in patches))


def _area_m2(body: Body) -> float:
    return math.fsum(area(geom.type, geom.size_m) for geom in body.geoms)


def _points(body: Body, layout: Layout, moved_m: dict[Any, FloatArray]) -> FloatArray:
    """Return the points of a body; those of a left one mirror those of a right one.

    Args:
        body: The body.
        layout: Its points at 18 months.
        moved_m: The points of bodies so far, before they are mirrored, to which those of this one are added.
    """
    left = body.name.startswith("left_")
    geoms = [_mirrored(geom) for geom in body.geoms] if left else body.geoms
    key = *map(id, layout), *((geom.type, geom.size_m, geom.pos_m, geom.euler_deg) for geom in geoms)
    if key not in moved_m:
        moved_m[key] = move_with_geoms(layout, geoms)
    points_m = moved_m[key].round(DECIMALS) * (1, -1 if left else 1, 1) + 0.0  # + 0.0 turns -0.0 into 0.
    points_m.flags.writeable = False
    return points_m


def _mirrored(geom: Geom) -> Geom:
    """Return a geom mirrored in y, which reverses rotations about x and z."""
    (x, y, z), (about_x, about_y, about_z) = geom.pos_m, geom.euler_deg
    return replace(geom, pos_m=(x, -y, z), euler_deg=(-about_x, about_y, -about_z))
