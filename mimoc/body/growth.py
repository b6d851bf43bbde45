"""Construction of a body from measurements and an anatomy."""

import math
from collections.abc import Mapping
from functools import cache, lru_cache
from types import MappingProxyType

from mimoc.body.anatomy import REFERENCE_AGE_MONTHS, TENDONS
from mimoc.body.assembly import Anatomy, assemble
from mimoc.body.density import reference_volumes
from mimoc.body.figures import GeomFigures, JointFigures, MotorFigures, Part
from mimoc.body.maturing.mature import mature, relative_volumes
from mimoc.body.maturing.parts import matured
from mimoc.body.solids import Heavier, Scales, Solids, heavier_parts, matured_solids, measured_solids, published_solids
from mimoc.body.tree import Body, BodyTree, Geom, Growth, Joint, Motor, Tendon, Vec3
from mimoc.fits import Measurements, measure
from mimoc.schema.names import Development

HEIGHT = "crown_sole_length"


def grow(
    measurements: Measurements,
    anatomy: Anatomy,
    scales: Scales = MappingProxyType({}),
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
    published, own, heavier = _solids(measurements, anatomy, scales, development)
    reference = matured(anatomy) if heavier else anatomy
    growth = {side: _growth(solids, anatomy.hands) for side, solids in published.items()}
    tree = BodyTree(
        age_months=measurements.age_months,
        hands=anatomy.hands,
        bodies=tuple(_body(part, side, own[side]) for side, part in reference.parts),
        motors=tuple(_motor(figures, side, growth[side][figures.mover]) for side, figures in anatomy.motors),
        tendons=tuple(Tendon(name, (-half, half), factors) for name, half, factors in TENDONS),
        excluded=reference.excluded,
        development=development,
    )
    return _matured(tree, anatomy, measurements, heavier) if heavier else tree


def weigh(measurements: Measurements, anatomy: Anatomy, development: Development) -> float:
    """Return the mass of the body that `grow` returns, in [kg], without what does not weigh.

    Raises:
        GeometryError: If no body has these measurements.
    """
    _, own, heavier = _solids(measurements, anatomy, {}, development)
    parts = matured(anatomy).parts if heavier else anatomy.parts
    return math.fsum(own[side].masses_kg[figures.name] for side, part in parts for figures in part.geoms)


def _solids(
    measurements: Measurements, anatomy: Anatomy, scales: Scales, development: Development
) -> tuple[Mapping[str, Solids], Mapping[str, Solids], Heavier | None]:
    """Return the solids of each side by the published law and by the child's own, and what the law `maturing` adds."""
    published = published_solids(measurements, anatomy, scales)
    if development != "maturing":
        return published, measured_solids(measurements, anatomy, scales, published), None
    heavier = heavier_parts(measurements, anatomy)
    return published, matured_solids(measurements, matured(anatomy), scales, published, heavier), heavier


def _matured(tree: BodyTree, anatomy: Anatomy, measurements: Measurements, heavier: Heavier) -> BodyTree:
    """Return a body that has grown by the published law, changed to what it is at its age."""
    growth = Growth(
        relative_length=measurements.published[HEIGHT] / measure(REFERENCE_AGE_MONTHS).published[HEIGHT],
        relative_volumes=relative_volumes(tree, anatomy),
        head_gain=heavier.head_gain,
        foot_height=heavier.foot_height,
        trunk_left=heavier.trunk_left,
    )
    return mature(tree, anatomy, growth)


@lru_cache(maxsize=8)
def grow_average(age_months: float, anatomy: Anatomy, development: Development = "maturing") -> BodyTree:
    """Return the body of the average child of an age."""
    return grow(measure(age_months), anatomy, development=development)


@cache
def grow_reference(hands: str, development: Development = "maturing") -> BodyTree:
    """Return the body of the average child of 18 months."""
    return grow_average(REFERENCE_AGE_MONTHS, assemble(hands, False), development)


def _growth(solids: Solids, hands: str) -> dict[str, float]:
    """Return the volume of each geom relative to the average child of 18 months, by its name with `{side}`."""
    reference = reference_volumes(hands)
    return {name: volume_m3 / reference[name] for name, volume_m3 in solids.volumes_m3.items()}


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


def _body(part: Part, side: str, solids: Solids) -> Body:
    left, dimensions = side == "left", solids.dimensions
    return Body(
        name=part.name.format(side=side),
        parent=part.parent and part.parent.format(side=side),
        pos_m=_mirror(dimensions.origins[part.name], left),
        euler_deg=_mirror_turn(part.euler_deg, left),
        joints=tuple(_joint(figures, side, dimensions.anchors) for figures in part.joints),
        geoms=tuple(_geom(figures, side, solids) for figures in part.geoms),
        region=part.region,
        group=part.group.format(side=side),
        skin_spacing_m=part.skin_spacing_m,
        torque_site=part.torque_site.format(side=side),
    )


def _geom(figures: GeomFigures, side: str, solids: Solids) -> Geom:
    left = side == "left"
    solid = solids.dimensions.shapes[figures.name]
    return Geom(
        name=figures.name.format(side=side),
        type=figures.type,
        size_m=solid.size_m,
        pos_m=_mirror(solid.pos_m, left),
        euler_deg=_mirror_turn(figures.euler_deg, left),
        mass_kg=solids.masses_kg[figures.name],
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
