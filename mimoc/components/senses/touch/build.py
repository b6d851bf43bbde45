"""Touch on a body: its skin points, evenly over the exposed surface of its geoms."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import permutations
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from mimoc.anatomy.anatomy import assemble
from mimoc.base.geometry import primitives
from mimoc.base.geometry.primitives import area, ellipse_perimeter
from mimoc.base.geometry.rotations import FloatArray, matrix_from_euler
from mimoc.base.units import cm_to_m
from mimoc.body.grow import grow_average
from mimoc.body.reference import REFERENCE_AGE_MONTHS
from mimoc.body.tree import PALMS_AND_SOLES, Body, BodyTree, Geom, region_of_bodies
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.touch import SkinEntry, TouchEntry, TouchSpec
from mimoc.schema.base import on_recompose
from mimoc.schema.names import Development, single_groups


def place(geom: Geom, multiples: FloatArray) -> FloatArray:
    """Return points given as multiples of the sizes of a geom, shape (n, 3), in the frame of its body.

    Args:
        geom: The geom.
        multiples: Of its radii or half edges along x, y and z of its own frame, then of the half length of the axis
            of a capsule, shape (n, 4).
    """
    radius_m, *half_m = geom.size_m
    radii_m = geom.size_m if geom.type in ("box", "ellipsoid") else (radius_m, radius_m, radius_m)
    if geom.type == "cylinder":
        radii_m = (radius_m, radius_m, half_m[0])
    local = multiples[:, :3] * np.array(radii_m)
    if geom.type == "capsule":
        local[:, 2] += multiples[:, 3] * half_m[0]
    return local @ matrix_from_euler(geom.euler_deg).T + geom.pos_m


def depth(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the depth of places in the frame of a body inside a geom, shape (n,); outside negative, at most so far."""
    return primitives.depths(geom.type, geom.size_m, _local(geom, points_m))


def outward(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the directions to the nearest points of a geom's surface from places inside of it, shape (n, 3)."""
    ways = primitives.outward(geom.type, geom.size_m, _local(geom, points_m))
    return ways @ matrix_from_euler(geom.euler_deg).T


def _local(geom: Geom, points_m: FloatArray) -> FloatArray:
    return (points_m - geom.pos_m) @ matrix_from_euler(geom.euler_deg)


Layout = tuple[FloatArray, ...]  # The points of each geom, as `place` takes them.

CLEARANCE = 1e-4
"""Height above its geom, relative to the geom's half breadth, at which a point must be outside of all other geoms: so
faces that coincide have no points."""
MIN_DISTANCE = 0.6  # Least distance of points of different geoms, in spacings; one of two closer points is left out.
DEPTH_TOLERANCE_M = 1e-10  # A point deeper than this is inside a geom.
MIN_SLOPE = 1e-12  # Least angle of two surfaces in rad, so that a division by it is safe.
MAX_STEPS = 50  # More than any body needs.


def lay_out(geoms: Sequence[Geom], spacing_m: float) -> Layout:
    """Return points about a spacing apart on the surface of some geoms where no other geom covers it."""
    layout: list[FloatArray] = []
    for index, geom in enumerate(geoms):
        multiples = even_points(geom, spacing_m)
        for other in (*geoms[:index], *geoms[index + 1 :]):
            multiples = multiples[depth(other, place(geom, (1 + CLEARANCE) * multiples)) <= 0]
        for other, theirs in zip(geoms, layout, strict=False):
            # Those points of a geom that are at least a distance from those of another one.
            distance_m = MIN_DISTANCE * spacing_m
            points_m, others_m = place(geom, multiples), place(other, theirs)
            near = np.flatnonzero(depth(other, points_m) > -distance_m)
            others_m = others_m[depth(geom, others_m) > -distance_m]
            gaps_m = np.linalg.norm(points_m[near, None] - others_m, axis=2)
            multiples = np.delete(multiples, near[(gaps_m < distance_m).any(axis=1)], axis=0)
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


def _to_surface(geom: Geom, points_m: FloatArray) -> FloatArray:
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


PUPIL = np.array([[1.0, 0.0, 0.0, 0.0]])  # The one point of an eye, at its front.

DECIMALS = 12
"""Decimals of coordinates in m: few enough not to depend on the order of sums, and a point is still on its surface."""


@dataclass(frozen=True, slots=True)
class SkinPoints:
    """Points on the surface of each body."""

    points_m: Mapping[str, FloatArray]  # By body, in the order of the model, shape (n, 3), in the frame of the body.
    spacing_m: Mapping[str, float]  # Distance of neighbours by body.


class _Patch(NamedTuple):
    """The skin of one body of the average child of 18 months; where its geoms cover each other, the area counts."""

    layout: Layout
    spacing_m: float
    area_m2: float


def skin_points(
    tree: BodyTree, density: float, regions: Collection[str] | None = None, given_m: Mapping[str, float] | None = None
) -> SkinPoints:
    """Return the skin points of a grown body.

    They are distributed over the average child of 18 months, and move with the geoms that they are on, so all infants
    have the same ones. As a body grows, the distance of its points grows with the root of its area, and so does what
    counts as their spacing: a contact is shared by the same number of points at every age.

    Args:
        tree: The body.
        density: Number of points, relative to what two-point discrimination asks for.
        regions: The groups of muscles whose parts have skin; None is all.
        given_m: Distance of neighbours at 18 months, by the parts that alone have skin then, in place of *density*.
    """
    kind = tree.hands, tree.extra, tree.development
    groups = tree.body_groups
    covered = None if regions is None else single_groups(regions)
    points_m, spacing_m, moved_m = {}, {}, dict[Any, FloatArray]()
    for body in tree.bodies:
        if covered is not None and groups[body.name] not in covered:
            continue
        parts = tree.parts_of(body.name)
        apart_m = None if given_m is None else next((given_m[part] for part in parts if part in given_m), None)
        if given_m is not None and apart_m is None:
            continue
        joined = [_patch(*kind, part.removeprefix("left_").removeprefix("right_"), density, apart_m) for part in parts]
        points_m[body.name] = _points(body, tuple(geom for patch in joined for geom in patch.layout), moved_m)
        growth = _area_m2(body) / math.fsum(patch.area_m2 for patch in joined)
        spacing_m[body.name] = joined[0].spacing_m * math.sqrt(growth)
    return SkinPoints(points_m, spacing_m)


@lru_cache(maxsize=8)
def _average_bodies(hands: str, extra: tuple[str, ...], development: Development) -> Mapping[str, Body]:
    """Return the bodies of the midline and of the right side of the average child, by name without its side."""
    tree = grow_average(REFERENCE_AGE_MONTHS, assemble(hands, False, development, extra))
    bodies = [body for body in tree.bodies if not body.name.startswith("left_")]
    return MappingProxyType({body.name.removeprefix("right_"): body for body in bodies})


@lru_cache(maxsize=512)
def _patch(
    hands: str, extra: tuple[str, ...], development: Development, part: str, density: float, apart_m: float | None
) -> _Patch:
    body = _average_bodies(hands, extra, development)[part]
    area_m2 = _area_m2(body)
    if body.skin_spacing_m is None:
        return _Patch((PUPIL,), math.sqrt(area_m2), area_m2)
    spacing_m = apart_m or body.skin_spacing_m / math.sqrt(density)
    return _Patch(lay_out(body.geoms, spacing_m), spacing_m, area_m2)


on_recompose(_average_bodies.cache_clear)  # Others' parts may be replaced.
on_recompose(_patch.cache_clear)


def _area_m2(body: Body) -> float:
    return math.fsum(area(geom.type, geom.size_m) for geom in body.geoms)


def _points(body: Body, layout: Layout, moved_m: dict[Any, FloatArray]) -> FloatArray:
    """Return the points of a body from its layout at 18 months; those of a left one mirror those of a right one.

    The points of bodies so far, before they are mirrored, are in *moved_m*, to which those of this one are added.
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


ARC_STEPS = 720
"""Chords that an ellipse's outline is measured with; they are shorter than it by less than one part in 10,000."""


def even_points(geom: Geom, spacing_m: float) -> FloatArray:
    """Return about one point for each square of a spacing, as the multiples that `place` takes, shape (n, 4).

    Those of a box are in the middle of equal cells, all others on rings.
    """
    if geom.type == "box":
        return _on_box(geom.size_m, spacing_m)
    if geom.type == "ellipsoid":
        return _on_ellipsoid(geom.size_m, spacing_m)
    radius_m, half_m = (*geom.size_m, 0.0)[:2]
    return (_on_cylinder if geom.type == "cylinder" else _on_capsule)(radius_m, half_m, spacing_m)


def _on_box(half_edges_m: tuple[float, ...], spacing_m: float) -> FloatArray:
    cells = [_cells(_count(2 * half_m, spacing_m)) for half_m in half_edges_m]
    ends = np.array((-1.0, 1.0))
    faces = [np.meshgrid(*cells[:axis], ends, *cells[axis + 1 :]) for axis in range(3)]
    points = np.concatenate([np.stack([column.ravel() for column in face], axis=1) for face in faces])
    return np.column_stack((points, np.zeros(len(points))))


def _on_cylinder(radius_m: float, half_m: float, spacing_m: float) -> FloatArray:
    count = _count(2 * half_m, spacing_m)
    side = _rings(np.ones(count), _cells(count), radius_m * 2 * half_m / count / spacing_m**2)
    count = _count(radius_m, spacing_m)
    per_radian = radius_m**2 / count / spacing_m**2
    radii = (np.arange(count) + 0.5) / count
    radii[2 * math.pi * radii * per_radian < 1.5] = 0.0  # A single point is in the middle.
    return np.concatenate((side, *(_rings(radii, np.full(count, end), per_radian) for end in (-1.0, 1.0))))


def _on_capsule(radius_m: float, half_m: float, spacing_m: float) -> FloatArray:
    """Return points on rings that are equally far apart along the outline, from pole to pole."""
    cap_m, tube_m = math.pi / 2 * radius_m, 2 * half_m
    outline_m = cap_m + tube_m + cap_m
    count = _count(outline_m, spacing_m)
    from_pole_m = (_cells(count) + 1) / 2 * outline_m
    on_tube_m = np.clip(from_pole_m - cap_m, 0, tube_m)
    angles_rad = (from_pole_m - on_tube_m) / radius_m
    along = 2 * on_tube_m / tube_m - 1 if tube_m else np.zeros(count)
    per_radian = radius_m * outline_m / count / spacing_m**2
    return _rings(np.sin(angles_rad), -np.cos(angles_rad), per_radian, along)


def _on_ellipsoid(half_axes_m: tuple[float, ...], spacing_m: float) -> FloatArray:
    """Return points on level rings, equally far apart along the outline of a mean breadth and on each ring."""
    a, b, c = half_axes_m
    angles_rad, from_pole_m = _arcs(math.sqrt(a * b), c, math.pi)
    count = _count(from_pole_m[-1], spacing_m)
    polar_rad = np.interp((_cells(count) + 1) / 2 * from_pole_m[-1], from_pole_m, angles_rad)
    per_radian = ellipse_perimeter(a, b) / (2 * math.pi) * from_pole_m[-1] / count / spacing_m**2
    rings = _rings(np.sin(polar_rad), -np.cos(polar_rad), per_radian)
    angles_rad, around_m = _arcs(b, a, 2 * math.pi)
    evenly_m = np.arctan2(rings[:, 1], rings[:, 0]) % (2 * math.pi) / (2 * math.pi) * around_m[-1]
    turns_rad = np.interp(evenly_m, around_m, angles_rad)
    radii = np.hypot(rings[:, 0], rings[:, 1])
    return np.column_stack((radii * np.cos(turns_rad), radii * np.sin(turns_rad), rings[:, 2:]))


def _arcs(along: float, across: float, end_rad: float) -> tuple[FloatArray, FloatArray]:
    """Return angles from zero to an end, and how far an ellipse's outline is there from where it began.

    It begins at the end of the half axis `across`, and goes towards that of `along`.
    """
    angles_rad = np.linspace(0, end_rad, ARC_STEPS + 1)
    steps = np.hypot(np.diff(along * np.sin(angles_rad)), np.diff(across * np.cos(angles_rad)))
    return angles_rad, np.concatenate(([0.0], np.cumsum(steps)))


def _rings(radii: FloatArray, heights: FloatArray, per_radian: float, along: FloatArray | None = None) -> FloatArray:
    """Return points on k rings about z; every other ring is turned by half a step, counted from the nearer end.

    *per_radian* is the number of points on one radian of a ring of radius one; *along* is the last multiple of the
    points of each ring.
    """
    counts = np.maximum(np.rint(2 * math.pi * radii * per_radian), 1).astype(int)
    ring = np.repeat(np.arange(len(radii)), counts)
    number = np.arange(len(ring)) - np.repeat(np.cumsum(counts) - counts, counts)
    turn = np.minimum(ring, len(radii) - 1 - ring) % 2 / 2
    angles_rad = 2 * math.pi * (number + turn) / counts[ring]
    last = np.zeros(len(ring)) if along is None else along[ring]
    return np.column_stack((radii[ring] * np.cos(angles_rad), radii[ring] * np.sin(angles_rad), heights[ring], last))


def _cells(count: int) -> FloatArray:
    return (2 * np.arange(count) + 1) / count - 1


def _count(length_m: float, spacing_m: float) -> int:
    return max(1, round(length_m / spacing_m))


SPACING_RULE = "two-point discrimination there at 18 months (MIMo) / sqrt(density), grown with the body's skin"
GIVEN_RULE = "given by the spec for 18 months, grown with the body's skin"

CHANNELS_KEY = "spec.senses.touch.channels"
CHANNELS_RULE = (
    "derived (D; mimoc/components/senses/touch/adaptation.py) from adults' fingertips (Johansson & Vallbo 1979, "
    "Bolanowski 1988; from memory); no infant was measured"
)


def build(spec: TouchSpec, body: BodyTree) -> Placed:
    """Return the entry, and the skin points of the body as an array; nothing stands for them in the MJCF."""
    given_m = spec.spacing_cm and {part: cm_to_m(apart_cm) for part, apart_cm in spec.spacing_cm.items()}
    skin = skin_points(body, spec.density, spec.regions, given_m)
    parts = tuple(
        SkinEntry(body=name, points=len(points_m), spacing_m=skin.spacing_m[name])
        for name, points_m in skin.points_m.items()
    )
    origins = {
        f"skin.{part.body}.spacing": {
            "value": part.spacing_m,
            "unit": "m",
            "rule": GIVEN_RULE if given_m else SPACING_RULE,
            "from": [f"spec.senses.touch.{_key(part.body, body, given_m)}", "spec.age_months"],
        }
        for part in parts
    }
    points_m = np.concatenate([np.empty((0, 3)), *skin.points_m.values()])
    regions, channels = region_of_bodies(body), spec.channels or ()
    hairless = tuple(part.body for part in parts if "ct" in channels and regions[part.body] in PALMS_AND_SOLES)
    entry = TouchEntry(
        quantity="normal" if channels else spec.quantity,
        response=spec.response,
        skin=parts,
        channels=channels,
        hairless=hairless,
    )
    if channels:
        origins["touch.channels"] = {"value": list(channels), "rule": CHANNELS_RULE, "from": [CHANNELS_KEY]}
    return Placed(entry, arrays={"points_m": points_m}, origins=origins)


def _key(name: str, body: BodyTree, given_m: Mapping[str, float] | None) -> str:
    """Return the key of the section that says how far apart the points of a body are."""
    if not given_m:
        return "density"
    return f"spacing_cm.{next(part for part in body.parts_of(name) if part in given_m)}"
