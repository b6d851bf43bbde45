"""Sizes and places of the parts of a child: as they are built, and the volumes that masses and strength follow.

A spec scales single parts in length and girth; the proportions that result are checked.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeVar

from mimoc.anatomy.anatomy import Sided
from mimoc.anatomy.part import ALONG_X, ALONG_Y, BodyGeometry, GeomShape, ReferenceGeom, ReferencePart
from mimoc.anatomy.parts.head import maturing_head_dimensions
from mimoc.anatomy.sections import room_beside
from mimoc.anatomy.segments import proportions
from mimoc.base.errors import GeometryError
from mimoc.base.geometry.rotations import Vec3
from mimoc.body.published import FORMULAS, published_dimensions
from mimoc.body.reference import Reference, dimensions_of, mimos_dimensions, mimos_volumes
from mimoc.fits import Measurements

LIMBS = (
    ("{side}_uarm1", "{side}_lower_arm"),
    ("{side}_larm", "{side}_hand"),
    ("{side}_upper_leg1", "{side}_lower_leg"),
    ("{side}_lower_leg1", "{side}_foot"),
)
"""The solid of each long segment, and the part at whose joint it ends."""


def _check_limbs(dimensions: BodyGeometry) -> None:
    for geom, end in LIMBS:
        length_m = math.dist(dimensions.origins[end], (0, 0, 0))
        thickness_m = 2 * dimensions.shapes[geom].size_m[0]
        if thickness_m >= length_m:
            raise GeometryError(f"a limb {length_m:.3f} m long cannot be {thickness_m:.3f} m thick")


DEEPEST = 1.0
"""Largest overlap of upper body and pelvis when the body stands, in radii of the pelvis: beyond it the upper body would
begin below the middle of the pelvis. They do not touch each other, so up to there nothing pushes them apart."""


def _check_trunk(dimensions: BodyGeometry) -> None:
    """Raise a GeometryError if upper body and pelvis, which are separated by two joints, overlap too much."""
    pelvis, belly = dimensions.shapes["lb"], dimensions.shapes["ub1"]
    on_belly = [
        sum(axis) for axis in zip(*(dimensions.origins[body] for body in ("lower_body", "upper_body")), strict=True)
    ]
    x, _, z = (a + b - c for a, b, c in zip(on_belly, belly.pos_m, pelvis.pos_m, strict=True))
    depth_m = pelvis.size_m[0] + belly.size_m[0] - math.hypot(x, z)
    if depth_m > DEEPEST * pelvis.size_m[0]:
        raise GeometryError(
            f"the upper body would reach {depth_m:.3f} m into a pelvis {2 * pelvis.size_m[0]:.3f} m thick"
        )


PRESSED = 0.5
"""How deep an upper arm at rest may be in the upper body, in its radii (D); contacts fling out deeper ones."""


def _clear_arms(dimensions: BodyGeometry, abduction_deg: float) -> BodyGeometry:
    """Return dimensions whose arms are moved outwards if they would be in the upper body by more than `PRESSED`.

    Hanging arms are that far from the vertical when all joints are at zero.
    """
    arm, ribs = dimensions.shapes["{side}_uarm1"], dimensions.shapes["ub2"]
    x_m, y_m, z_m = dimensions.origins["{side}_upper_arm"]
    chest_x_m, _, chest_z_m = dimensions.origins["chest"]
    room_m = arm.pos_m[1] + room_beside(
        outwards_m=-y_m - ribs.size_m[1],
        above_m=z_m + chest_z_m - ribs.pos_m[2],
        behind_m=x_m + chest_x_m - ribs.pos_m[0],
        apart_m=ribs.size_m[0] + (1 - PRESSED) * arm.size_m[0],
        abduction_deg=abduction_deg,
    )
    if room_m >= 0:
        return dimensions
    outwards_m = -room_m / math.cos(math.radians(abduction_deg))
    return dimensions | BodyGeometry({"{side}_upper_arm": (x_m, y_m - outwards_m, z_m)})


def _scale_part(
    dimensions: BodyGeometry, name: str, parts: Iterable[ReferencePart], length: float, girth: float
) -> BodyGeometry:
    """Return dimensions of one side in which a part of it, named with `{side}`, is scaled along and across itself."""
    children = [part.name for part in parts if part.parent == name]
    (part,) = (part for part in parts if part.name == name)
    scale = (length, girth, girth) if part.runs_along_x else (girth, girth, length)
    joints = [joint.name for joint in part.joints if joint.name in dimensions.anchors]
    return dimensions | BodyGeometry(
        origins={child: _times(dimensions.origins[child], scale) for child in children},
        shapes={geom.name: _scale_solid(dimensions.shapes[geom.name], geom, scale) for geom in part.geoms},
        anchors={joint: _times(dimensions.anchors[joint], scale) for joint in joints},
    )


def _scale_solid(solid: GeomShape, geom: ReferenceGeom, scale: Vec3) -> GeomShape:
    x, y, z = scale
    turned: Mapping[Vec3, Vec3] = {ALONG_Y: (x, z, y), ALONG_X: (z, y, x)}
    x, y, z = turned.get(geom.euler_deg, scale)  # Geoms are turned by at most a right angle.
    if geom.type == "sphere":
        size_m: tuple[float, ...] = (solid.size_m[0] * math.cbrt(x * y * z),)
    elif geom.type in ("box", "ellipsoid"):
        size_m = _times((solid.size_m[0], solid.size_m[1], solid.size_m[2]), (x, y, z))
    else:
        radius_m, half_m = solid.size_m
        size_m = (radius_m * math.sqrt(x * y), half_m * z)
    return GeomShape(size_m, _times(solid.pos_m, scale))


def _times(vector: Vec3, scale: Vec3) -> Vec3:
    x, y, z = (component * factor for component, factor in zip(vector, scale, strict=True))
    return x, y, z


SIDES = ("", "right", "left")

Factors = tuple[float, float]  # Factors on the length and the girth of a part.
Scales = Mapping[str, Factors]  # By the name of the body.
NO_SCALES: Scales = MappingProxyType({})
Volumes = Mapping[str, float]  # In m³, by name of the geom with `{side}`.
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Shapes:
    """The shapes of a child's parts, by side: `right`, `left`, and empty for the middle."""

    built: Mapping[str, BodyGeometry]  # Shapes as they are built, by the child's law of development.
    mimos_m3: Mapping[str, Volumes]
    """Volumes of MIMo's solids with the child's measurements, by the growth law of the paper: only the published law
    builds these solids."""
    usual: BodyGeometry
    """Shapes that would be built if the spec replaced no measurement and scaled no part: of all sides."""
    usual_m3: Volumes  # Volumes of MIMo's solids then.

    def of_sides(self, function: Callable[[str], T]) -> dict[str, T]:
        """Return what a function returns for each side, called once if both sides are alike."""
        return _of_sides(function, alike=self.built["right"] is self.built["left"])


def shape_parts(child: Measurements, reference: Reference, scales: Scales = NO_SCALES) -> Shapes:
    """Return the shapes of a child's parts, single ones by *scales* of length and girth, or raise a GeometryError."""
    anatomy = reference.anatomy
    alike = child.symmetric and not scales

    def mimos_m3(child: Measurements, scales: Scales, side: str) -> Volumes:
        dimensions = mimos_dimensions(child.paper_law, side, anatomy.kinds)
        return mimos_volumes(_scaled(dimensions, anatomy.mimos_parts, scales, side), anatomy)

    def built(child: Measurements, scales: Scales, side: str) -> BodyGeometry:
        dimensions = _scaled(_shape(child, side, reference), anatomy.parts, scales, side)
        (_check_limbs if side else _check_trunk)(dimensions)
        return dimensions

    is_published = anatomy.development == "published"
    before = child.unreplaced
    volumes_m3 = {} if is_published else _of_sides(lambda side: mimos_m3(child, scales, side), alike=alike)
    usual, usual_m3 = None, volumes_m3.get("")
    if not is_published and (scales or before is not child):
        usual_m3, usual = mimos_m3(before, NO_SCALES, ""), built(before, NO_SCALES, "")
    dimensions = _of_sides(lambda side: built(child, scales, side), alike=alike)
    if alike:
        _check_limbs(dimensions[""])
    if is_published:
        volumes_m3 = _of_sides(lambda side: mimos_volumes(dimensions[side], anatomy), alike=alike)
    return Shapes(dimensions, volumes_m3, usual or dimensions[""], usual_m3 or volumes_m3[""])


def _shape(child: Measurements, side: str, reference: Reference) -> BodyGeometry:
    """Return shapes with the child's measurements: MIMo's very shapes, or by `maturing` measured ones."""
    if reference.anatomy.development == "published":
        kinds = reference.anatomy.kinds
        foreign = [kind for kind in kinds if kind.name not in FORMULAS]
        return published_dimensions(child, side, kinds) | mimos_dimensions(child, side, foreign)
    p = proportions(child.of_side(side), child.base_m, foot_height=reference.foot_height)
    return dimensions_of(p, reference.anatomy.kinds) | maturing_head_dimensions(p)


def _of_sides(function: Callable[[str], T], *, alike: bool) -> dict[str, T]:
    return dict.fromkeys(SIDES, function("")) if alike else {side: function(side) for side in SIDES}


def _scaled(dimensions: BodyGeometry, parts: Sided, scales: Scales, side: str) -> BodyGeometry:
    if not scales:
        return dimensions
    of_side = [part for part_side, part in parts if part_side in (side, "")]
    for part in of_side:
        if part.name.format(side=side) in scales:
            dimensions = _scale_part(dimensions, part.name, of_side, *scales[part.name.format(side=side)])
    (arm,) = (part for part in of_side if part.name == "{side}_upper_arm") if side else (None,)
    return _clear_arms(dimensions, 180 - arm.euler_deg[0]) if arm else dimensions
