"""From measurements to a body: anatomy takes the shapes that geometry gives it."""

from collections.abc import Iterator, Mapping
from functools import cache

from mimoc.body import anatomy
from mimoc.body.geometry import Layout, lay_out
from mimoc.body.mass import grown, volume
from mimoc.body.proportions import proportions
from mimoc.body.tree import Body, BodyTree, Geom, Joint, Motor, Tendon, Vec3
from mimoc.fits import Measurements, measure


def grow(measurements: Measurements) -> BodyTree:
    """Return the body of a child.

    Raises:
        GeometryError: If no body has these measurements.
    """
    layout = lay_out(proportions(measurements))
    bodies = tuple(_body(part, side, layout) for parts, sides in anatomy.GROUPS for side in sides for part in parts)
    return BodyTree(
        age_months=measurements.age_months,
        bodies=bodies,
        motors=tuple(_motors(layout)),
        tendons=tuple(Tendon(name, (-half, half), factors) for name, half, factors in anatomy.TENDONS),
        excluded=anatomy.EXCLUDED,
        frictionless=anatomy.FRICTIONLESS,
    )


@cache
def _reference_layout() -> Layout:
    """Return the layout of the average child of 18 months, whose masses and gears are the reference."""
    return lay_out(proportions(measure(anatomy.REFERENCE_AGE_MONTHS)))


def _body(part: anatomy.Part, side: str, layout: Layout) -> Body:
    left = side == "left"
    return Body(
        name=part.name.format(side=side),
        parent=part.parent and part.parent.format(side=side),
        pos_m=_mirror(layout.origins[part.name], left),
        euler_deg=_mirror_turn(part.euler_deg, left),
        joints=tuple(_joint(figures, side, layout.anchors) for figures in part.joints),
        geoms=tuple(_geom(figures, side, layout) for figures in part.geoms),
    )


def _geom(figures: anatomy.GeomFigures, side: str, layout: Layout) -> Geom:
    left = side == "left"
    solid = layout.solids[figures.name]
    volume_m3 = volume(figures.type, solid.size_m)
    return Geom(
        name=figures.name.format(side=side),
        type=figures.type,
        size_m=solid.size_m,
        pos_m=_mirror(solid.pos_m, left),
        euler_deg=_mirror_turn(figures.euler_deg, left),
        volume_m3=volume_m3,
        mass_kg=grown(figures.mass_kg, volume_m3, _reference_volume(figures)),
        friction=figures.friction,
        contype=figures.contype,
        conaffinity=figures.conaffinity,
    )


def _joint(figures: anatomy.JointFigures, side: str, anchors: Mapping[str, Vec3]) -> Joint:
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


def _motors(layout: Layout) -> Iterator[Motor]:
    """Yield the motors in MIMo's order; a gear grows with the volume of the part that moves its joint."""
    movers = {figures.name: figures for parts, _ in anatomy.GROUPS for part in parts for figures in part.geoms}
    for group, sides in anatomy.MOTOR_GROUPS:
        for side in sides:
            for motor in group:
                mover = movers[motor.mover]
                volume_m3 = volume(mover.type, layout.solids[mover.name].size_m)
                yield Motor(
                    name=motor.name.format(side=side),
                    joint=motor.joint.format(side=side),
                    gear_nm=grown(motor.gear_nm, volume_m3, _reference_volume(mover)),
                    force_range=motor.force_range,
                    mover=mover.name.format(side=side),
                )


def _reference_volume(figures: anatomy.GeomFigures) -> float:
    return volume(figures.type, _reference_layout().solids[figures.name].size_m)


def _mirror(vector: Vec3, left: bool) -> Vec3:
    """Return a position, mirrored in y for the left side."""
    x, y, z = vector
    return (x, -y, z) if left else vector


def _mirror_turn(vector: Vec3, left: bool) -> Vec3:
    """Return an axis or Euler angles, mirrored in y: turns about x and z change sense, about y they do not."""
    x, y, z = vector
    return (-x, y, -z) if left else vector
