"""Shapes, volumes and masses of a child's parts, by either law of development."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mimoc.body.assembly import Anatomy
from mimoc.body.density import masses, volumes
from mimoc.body.dimensions import Dimensions
from mimoc.body.maturing.feet import foot_height
from mimoc.body.maturing.head import head_gain
from mimoc.body.maturing.masses import matured_masses, share_out
from mimoc.body.maturing.parts import matured
from mimoc.body.scaling import check_limbs, check_trunk, clear_arms, scale_part
from mimoc.body.shapes import MEASURED, MIMOS, Kind, Shapes, unscaled_shapes
from mimoc.fits import Measurements

SIDES = ("", "right", "left")

Factors = tuple[float, float]
"""Factors on the length and the girth of a part."""
Scales = Mapping[str, Factors]
"""By the name of the body."""


@dataclass(frozen=True, slots=True)
class Solids:
    """The geoms of the middle and of one side, by their names with `{side}`."""

    dimensions: Dimensions
    volumes_m3: Mapping[str, float]
    masses_kg: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Heavier:
    """What the law `maturing` changes in the masses of a child, relative to the published law."""

    head_gain: float
    """Mass of head and neck."""
    foot_height: float
    """Height of the feet."""
    trunk_left: float
    """Mass of the trunk."""


def published_solids(measurements: Measurements, anatomy: Anatomy, scales: Scales) -> dict[str, Solids]:
    """Return MIMo's solids of each side, whose volumes strength and masses follow by either law.

    They are never built, so nothing is wrong if they do not fit.

    Args:
        measurements: Measurements of the child.
        anatomy: Its parts.
        scales: Factors on single parts.
    """

    def of_side(side: str) -> Solids:
        shapes = _shapes(measurements.published, anatomy, scales, side, MIMOS)
        return Solids(*shapes, masses(anatomy, shapes[1]))

    return _of_sides(of_side, measurements, scales, built=False)


def measured_solids(
    measurements: Measurements, anatomy: Anatomy, scales: Scales, published: Mapping[str, Solids]
) -> dict[str, Solids]:
    """Return the solids of each side that have the child's measurements, with MIMo's head and feet.

    Args:
        measurements: Measurements of the child.
        anatomy: Its parts.
        scales: Factors on single parts.
        published: The same child's `published_solids`, whose masses they have.

    Raises:
        GeometryError: If no body has these measurements.
    """

    def of_side(side: str) -> Solids:
        return Solids(*_shapes(measurements, anatomy, scales, side, MEASURED), published[side].masses_kg)

    return _of_sides(of_side, measurements, scales)


def heavier_parts(measurements: Measurements, anatomy: Anatomy) -> Heavier:
    """Return what the law `maturing` changes in the masses of a child, before its spec changes any single part.

    Raises:
        GeometryError: If no body has these measurements.
    """
    child = measurements.unreplaced
    gain, height = head_gain(child.age_months, anatomy.hands), foot_height(child.age_months, anatomy.hands)
    _, published_m3 = _shapes(child.published, anatomy, {}, "", MIMOS)
    _, volumes_m3 = _shapes(child, matured(anatomy), {}, "", Kind(foot_height=height))
    gain, left = share_out(matured(anatomy), masses(anatomy, published_m3), volumes_m3, gain)
    return Heavier(gain, height, left)


def matured_solids(
    measurements: Measurements, anatomy: Anatomy, scales: Scales, published: Mapping[str, Solids], heavier: Heavier
) -> dict[str, Solids]:
    """Return the solids of each side, by the law `maturing`.

    Args:
        measurements: Measurements of the child.
        anatomy: Its parts by this law.
        scales: Factors on single parts.
        published: The same child by the published law.
        heavier: What is heavier and lighter.

    Raises:
        GeometryError: If no body has these measurements.
    """

    def of_side(side: str) -> Solids:
        kind = Kind(foot_height=heavier.foot_height)
        dimensions, volumes_m3 = _shapes(measurements, anatomy, scales, side, kind)
        usual_kg = published[side].masses_kg
        masses_kg = matured_masses(anatomy, usual_kg, volumes_m3, heavier.head_gain, heavier.trunk_left)
        return Solids(dimensions, volumes_m3, masses_kg)

    return _of_sides(of_side, measurements, scales)


def _of_sides(
    of_side: Callable[[str], Solids], measurements: Measurements, scales: Scales, *, built: bool = True
) -> dict[str, Solids]:
    """Return the solids of the middle and of each side; those of most children are the same ones.

    Raises:
        GeometryError: If they are *built*, and no body has these measurements.
    """
    if not measurements.symmetric or scales:
        return {side: of_side(side) for side in SIDES}
    same = of_side("")
    if built:
        check_limbs(same.dimensions)
    return dict.fromkeys(SIDES, same)


def _shapes(measurements: Measurements, anatomy: Anatomy, scales: Scales, side: str, kind: Kind) -> Shapes:
    """Return the shapes from one side's measurements, or from both sides' if *side* is empty.

    Args:
        measurements: Measurements of the child.
        anatomy: Its parts.
        scales: Factors on single parts.
        side: `left`, `right` or empty.
        kind: Which shapes.
    """
    shapes = unscaled_shapes(measurements, side, anatomy, kind)
    dimensions = shapes[0]
    parts = [part for here, part in anatomy.parts if here in (side, "")] if scales else []
    for part in parts:
        if part.name.format(side=side) in scales:
            dimensions = scale_part(dimensions, part.name, parts, *scales[part.name.format(side=side)])
    if scales:
        dimensions = clear_arms(dimensions)
    if not kind.published:
        check = check_limbs if side else check_trunk
        check(dimensions)
    return shapes if dimensions is shapes[0] else (dimensions, volumes(anatomy, dimensions))
