"""Masses and torques by the growth law of the paper: in proportion to the volumes of MIMo's solids."""

from dataclasses import dataclass
from typing import cast

from mimoc.anatomy.anatomy import Anatomy
from mimoc.anatomy.part import Region
from mimoc.body.reference import reference_body
from mimoc.body.shapes import shape_parts
from mimoc.fits import Measurements


@dataclass(frozen=True)
class ByVolume:
    """Masses and torques of a child in proportion to the volumes of MIMo's solids with its measurements."""

    masses_kg: dict[str, float]
    """By body."""
    gears_nm: dict[str, float]
    """By motor."""
    regions: dict[str, Region]
    """By body."""


def by_volume(child: Measurements, anatomy: Anatomy) -> ByVolume:
    reference = reference_body(anatomy, child.age_months)
    volumes_m3 = shape_parts(child, reference).mimos_m3
    masses_kg = {
        part.name.format(side=side): sum(
            reference.densities_kg_m3[geom.name] * volumes_m3[side][geom.name] for geom in part.geoms
        )
        for side, part in anatomy.mimos_parts
    }
    gears_nm = {
        motor.name.format(side=side): motor.gear_nm
        * cast(float, volumes_m3[side][motor.driven_geom] / reference.volumes_m3[motor.driven_geom])
        for side, motor in anatomy.motors
    }
    return ByVolume(
        masses_kg, gears_nm, {part.name.format(side=side): part.region for side, part in anatomy.mimos_parts}
    )
