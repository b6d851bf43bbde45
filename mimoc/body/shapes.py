"""Sizes and places of the parts of a child: as they are built, and the volumes that masses and strength follow."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeVar

from mimoc.body.anatomy import Sided
from mimoc.body.dimensions import Dimensions
from mimoc.body.parts.head import maturing_head_dimensions
from mimoc.body.proportions import proportions
from mimoc.body.reference import Reference, dimensions_of, mimos_dimensions, mimos_volumes
from mimoc.body.scaling import check_limbs, check_trunk, clear_arms, scale_part
from mimoc.fits import Measurements

SIDES = ("", "right", "left")

Factors = tuple[float, float]
"""Factors on the length and the girth of a part."""
Scales = Mapping[str, Factors]
"""By the name of the body."""
NO_SCALES: Scales = MappingProxyType({})
Volumes = Mapping[str, float]
"""In m³, by name of the geom with `{side}`."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Shapes:
    """The shapes of a child's parts, by side: `right`, `left`, and empty for the middle."""

    own: Mapping[str, Dimensions]
    """As they are built, by the child's law of development."""
    published_m3: Mapping[str, Volumes]
    """Of MIMo's solids with the child's measurements, by the growth law of the paper. They are never built."""
    usual: Dimensions
    """As they would be built if the spec replaced no measurement and scaled no part, of the middle and both sides."""
    usual_m3: Volumes
    """Volumes of MIMo's solids then."""

    def of_sides(self, function: Callable[[str], T]) -> dict[str, T]:
        """Return what a function returns for each side, called once if both sides are alike."""
        return _of_sides(function, alike=self.own["right"] is self.own["left"])


def shape_parts(child: Measurements, reference: Reference, scales: Scales = NO_SCALES) -> Shapes:
    """Return the shapes of a child's parts.

    Args:
        child: Measurements of the child.
        reference: What it is compared with.
        scales: Factors on length and girth of single parts.

    Raises:
        GeometryError: If no body has these measurements.
    """
    anatomy, alike = reference.anatomy, child.symmetric and not scales
    shape = _LAWS[anatomy.development]

    def published_m3(child: Measurements, scales: Scales, side: str) -> Volumes:
        dimensions = mimos_dimensions(child.published, side, anatomy)
        return mimos_volumes(_scaled(dimensions, anatomy.mimos_parts, scales, side), anatomy)

    def own(child: Measurements, scales: Scales, side: str) -> Dimensions:
        dimensions = _scaled(shape(child, side, reference), anatomy.parts, scales, side)
        (check_limbs if side else check_trunk)(dimensions)
        return dimensions

    volumes_m3 = _of_sides(lambda side: published_m3(child, scales, side), alike=alike)
    before = child if anatomy.development == "published" else child.unreplaced
    changed = bool(scales) or before is not child
    usual_m3 = published_m3(before, NO_SCALES, "") if changed else volumes_m3[""]
    usual = own(before, NO_SCALES, "") if changed else None
    dimensions = _of_sides(lambda side: own(child, scales, side), alike=alike)
    if alike:
        check_limbs(dimensions[""])
    return Shapes(dimensions, volumes_m3, usual or dimensions[""], usual_m3)


def _published(child: Measurements, side: str, reference: Reference) -> Dimensions:
    """Return shapes with the child's measurements, MIMo's head and MIMo's feet."""
    return dimensions_of(proportions(child.of_side(side), child.base_m), reference.anatomy.kinds)


def _maturing(child: Measurements, side: str, reference: Reference) -> Dimensions:
    """Return shapes with the child's measurements, an ellipsoid as head, and the feet of its age."""
    p = proportions(child.of_side(side), child.base_m, foot_height=reference.foot_height)
    return dimensions_of(p, reference.anatomy.kinds) | maturing_head_dimensions(p)


_LAWS = {"published": _published, "maturing": _maturing}


def _of_sides(function: Callable[[str], T], *, alike: bool) -> dict[str, T]:
    return dict.fromkeys(SIDES, function("")) if alike else {side: function(side) for side in SIDES}


def _scaled(dimensions: Dimensions, parts: Sided, scales: Scales, side: str) -> Dimensions:
    """Return dimensions of one side in which the parts that a spec scales are scaled."""
    if not scales:
        return dimensions
    of_side = [part for part_side, part in parts if part_side in (side, "")]
    for part in of_side:
        if part.name.format(side=side) in scales:
            dimensions = scale_part(dimensions, part.name, of_side, *scales[part.name.format(side=side)])
    return clear_arms(dimensions)
