"""From measurements to a body: anatomy takes the shapes that geometry gives it."""

from collections.abc import Mapping
from functools import cache

from mimoc.body import anatomy
from mimoc.body.figures import GeomFigures, JointFigures, Part
from mimoc.body.geometry import Layout, lay_out
from mimoc.body.mass import volume
from mimoc.body.proportions import proportions
from mimoc.body.strength import motors
from mimoc.body.tree import Body, BodyTree, Geom, Joint, Tendon, Vec3
from mimoc.fits import Measurements, measure


def grow(measurements: Measurements) -> BodyTree:
    """Return the body of a child.

    Raises:
        GeometryError: If no body has these measurements.
    """
    layout = lay_out(proportions(measurements))
    growth = {name: volume_m3 / _reference_volumes()[name] for name, volume_m3 in _volumes(layout).items()}
    bodies = tuple(
        _body(part, side, layout, growth) for parts, sides in anatomy.GROUPS for side in sides for part in parts
    )
    return BodyTree(
        age_months=measurements.age_months,
        bodies=bodies,
        motors=motors(growth),
        tendons=tuple(Tendon(name, (-half, half), factors) for name, half, factors in anatomy.TENDONS),
        excluded=anatomy.EXCLUDED,
        frictionless=anatomy.FRICTIONLESS,
    )


@cache
def _reference_volumes() -> Mapping[str, float]:
    """Return the volumes of the average child of 18 months, whose masses and gears are the reference."""
    return _volumes(lay_out(proportions(measure(anatomy.REFERENCE_AGE_MONTHS))))


def _volumes(layout: Layout) -> dict[str, float]:
    """Return the volume of each geom by its name in `anatomy`, in m³."""
    return {
        figures.name: volume(figures.type, layout.solids[figures.name].size_m)
        for parts, _ in anatomy.GROUPS
        for part in parts
        for figures in part.geoms
    }


def _body(part: Part, side: str, layout: Layout, growth: Mapping[str, float]) -> Body:
    left = side == "left"
    return Body(
        name=part.name.format(side=side),
        parent=part.parent and part.parent.format(side=side),
        pos_m=_mirror(layout.origins[part.name], left),
        euler_deg=_mirror_turn(part.euler_deg, left),
        joints=tuple(_joint(figures, side, layout.anchors) for figures in part.joints),
        geoms=tuple(_geom(figures, side, layout, growth[figures.name]) for figures in part.geoms),
    )


def _geom(figures: GeomFigures, side: str, layout: Layout, growth: float) -> Geom:
    left = side == "left"
    solid = layout.solids[figures.name]
    return Geom(
        name=figures.name.format(side=side),
        type=figures.type,
        size_m=solid.size_m,
        pos_m=_mirror(solid.pos_m, left),
        euler_deg=_mirror_turn(figures.euler_deg, left),
        mass_kg=figures.mass_kg * growth,
        friction=figures.friction,
        contype=figures.contype,
        conaffinity=figures.conaffinity,
    )


def _joint(figures: JointFigures, side: str, anchors: Mapping[str, Vec3]) -> Joint:
    left = side == "left"
    return Joint(
        name=figures.name.format(side=side),
        axis=_mirror_turn(figures.axis, left),
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
    """Return an axis or Euler angles, mirrored in y: turns about x and z change sense, about y they do not."""
    x, y, z = vector
    return (-x, y, -z) if left else vector
