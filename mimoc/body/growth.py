"""Construction of a body from measurements and an anatomy."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from mimoc.body.anatomy import FRICTIONLESS, REFERENCE_AGE_MONTHS, TENDONS
from mimoc.body.assembly import Anatomy, assemble
from mimoc.body.density import density, reference_volumes, volumes
from mimoc.body.figures import GeomFigures, JointFigures, MotorFigures, Part
from mimoc.body.maturing.head import head_gain
from mimoc.body.maturing.mature import mature, relative_volumes
from mimoc.body.proportions import proportions
from mimoc.body.scaling import check_limbs, check_trunk, scale_part
from mimoc.body.segments import Dimensions, body_dimensions
from mimoc.body.tree import Body, BodyTree, Geom, Growth, Joint, Motor, Tendon, Vec3
from mimoc.fits import Measurements, measure
from mimoc.schema.names import Development

SIDES = ("", "right", "left")
HEIGHT = "crown_sole_length"


Factors = tuple[float, float]
"""Factors on the length and the girth of a part."""


def grow(
    measurements: Measurements,
    anatomy: Anatomy,
    scales: Mapping[str, Factors] = MappingProxyType({}),
    development: Development = "maturing",
) -> BodyTree:
    """Return the body of a child.

    Args:
        measurements: Measurements of the child.
        anatomy: Its parts, joints and muscles.
        scales: Factors on length and girth of single parts, by the name of the body.
        development: The law of strength, joints and proportions.

    Raises:
        GeometryError: If no body has these measurements.
    """
    by_side = {side: _side_dimensions(measurements, anatomy, scales, side) for side in SIDES}
    published = {side: _side_dimensions(measurements.published, anatomy, scales, side, True) for side in SIDES}
    growth = {side: _growth(anatomy, dimensions) for side, dimensions in published.items()}
    masses = {
        side: _masses(anatomy, (published if development == "published" else by_side)[side], development)
        for side in SIDES
    }
    tree = BodyTree(
        age_months=measurements.age_months,
        hands=anatomy.hands,
        bodies=tuple(_body(part, side, by_side[side], masses[side]) for side, part in anatomy.parts),
        motors=tuple(_motor(figures, side, growth[side][figures.mover]) for side, figures in anatomy.motors),
        tendons=tuple(Tendon(name, (-half, half), factors) for name, half, factors in TENDONS),
        excluded=anatomy.excluded,
        frictionless=FRICTIONLESS,
        development=development,
    )
    return tree if development == "published" else _matured(tree, anatomy, measurements)


def _matured(tree: BodyTree, anatomy: Anatomy, measurements: Measurements) -> BodyTree:
    """Return a body that has grown by the published law, changed to what it is at its age."""
    growth = Growth(
        relative_length=measurements.published[HEIGHT] / measure(REFERENCE_AGE_MONTHS).published[HEIGHT],
        relative_volumes=relative_volumes(tree, anatomy),
        head_gain=head_gain(tree.age_months, tree.hands),
    )
    return mature(tree, anatomy, growth)


@cache
def grow_reference(hands: str, development: Development = "maturing") -> BodyTree:
    """Return the body of the average child of 18 months."""
    return grow(measure(REFERENCE_AGE_MONTHS), assemble(hands, False), development=development)


def _side_dimensions(
    measurements: Measurements, anatomy: Anatomy, scales: Mapping[str, Factors], side: str, published: bool = False
) -> Dimensions:
    """Return the dimensions from one side's measurements, or from both sides' if *side* is empty.

    The published ones, whose volumes strength follows, are never built, so nothing is wrong if they do not fit.
    """
    base = {name: measured.value_m for name, measured in measurements.base.items()}
    dimensions = body_dimensions(proportions(measurements.of_side(side), base, published), anatomy.hands)
    parts = [part for here, part in anatomy.parts if here in (side, "")]
    for part in parts:
        if part.name.format(side=side) in scales:
            dimensions = scale_part(dimensions, part.name, parts, *scales[part.name.format(side=side)])
    if not published:
        check_limbs(dimensions) if side else check_trunk(dimensions)
    return dimensions


def _growth(anatomy: Anatomy, published: Dimensions) -> dict[str, float]:
    """Return the published volume of each geom relative to the average child of 18 months."""
    reference = reference_volumes(anatomy.hands, published=True)
    return {name: volume_m3 / reference[name] for name, volume_m3 in volumes(anatomy, published).items()}


def _masses(anatomy: Anatomy, dimensions: Dimensions, development: Development) -> dict[str, float]:
    """Return the mass of each geom, in [kg], by its name with `{side}`."""
    densities = {
        name: density(figures, anatomy.hands, development == "published") for name, figures in anatomy.geoms.items()
    }
    return {name: densities[name] * volume_m3 for name, volume_m3 in volumes(anatomy, dimensions).items()}


def _motor(figures: MotorFigures, side: str, growth: float) -> Motor:
    """Return a motor, whose gear is proportional to the volume of the part that its joint moves."""
    return Motor(
        name=figures.name.format(side=side),
        joint=figures.joint.format(side=side),
        gear_nm=figures.gear_nm * growth,
        force_range=figures.force_range,
        vmax_lengths_per_s=figures.vmax_lengths_per_s,
        mover=figures.mover.format(side=side),
    )


def _body(part: Part, side: str, dimensions: Dimensions, masses_kg: Mapping[str, float]) -> Body:
    left = side == "left"
    return Body(
        name=part.name.format(side=side),
        parent=part.parent and part.parent.format(side=side),
        pos_m=_mirror(dimensions.origins[part.name], left),
        euler_deg=_mirror_turn(part.euler_deg, left),
        joints=tuple(_joint(figures, side, dimensions.anchors) for figures in part.joints),
        geoms=tuple(_geom(figures, side, dimensions, masses_kg[figures.name]) for figures in part.geoms),
        region=part.region,
        group=part.group.format(side=side),
        skin_spacing_m=part.skin_spacing_m,
        torque_site=part.torque_site.format(side=side),
    )


def _geom(figures: GeomFigures, side: str, dimensions: Dimensions, mass_kg: float) -> Geom:
    left = side == "left"
    solid = dimensions.shapes[figures.name]
    return Geom(
        name=figures.name.format(side=side),
        type=figures.type,
        size_m=solid.size_m,
        pos_m=_mirror(solid.pos_m, left),
        euler_deg=_mirror_turn(figures.euler_deg, left),
        mass_kg=mass_kg,
        friction=figures.friction,
        contype=figures.contype,
        conaffinity=figures.conaffinity,
        condim=figures.condim,
        material=figures.material.format(side=side),
    )


def _joint(figures: JointFigures, side: str, anchors: Mapping[str, Vec3]) -> Joint:
    left = side == "left"
    return Joint(
        name=figures.name.format(side=side),
        axis=figures.left_axis if left and figures.left_axis else _mirror_turn(figures.axis, left),
        anchor_m=_mirror(anchors.get(figures.name, (0.0, 0.0, 0.0)), left),
        range_deg=figures.range_deg,
        stiffness_nm_per_rad=figures.stiffness_nm_per_rad,
        damping_nms_per_rad=figures.damping_nms_per_rad,
        frictionloss_nm=figures.frictionloss_nm,
        armature_kgm2=figures.armature_kgm2,
        springref_deg=figures.springref_deg,
    )


def _mirror(vector: Vec3, left: bool) -> Vec3:
    """Return a position, mirrored in y for the left side."""
    x, y, z = vector
    return (x, -y, z) if left else vector


def _mirror_turn(vector: Vec3, left: bool) -> Vec3:
    """Return an axis or Euler angles, mirrored in y: rotations about x and z change sign, about y they do not."""
    x, y, z = vector
    return (-x, y, -z) if left else vector
