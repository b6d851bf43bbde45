"""Masses by the law `maturing`: heavier head and feet, at the expense of the trunk.

All other parts weigh what they do by the published law, and so does the whole body.
"""

from collections.abc import Callable, Iterator, Mapping

from mimoc.body.assembly import Anatomy
from mimoc.body.density import density
from mimoc.body.figures import GeomFigures, Part
from mimoc.errors import GeometryError

NECK_SHARE = 0.08
"""Of the neck in the mass of head and neck (D)."""
LEAST_TRUNK = 0.25
"""Of its mass by the published law, below which a trunk is lighter than anything made of flesh."""

Masses = Mapping[str, float]
"""In kg, by name of the geom with `{side}`."""


def matured_masses(anatomy: Anatomy, published_kg: Masses, volumes_m3: Masses, gain: float, trunk: float) -> Masses:
    """Return the masses of one side's and the middle's geoms.

    Args:
        anatomy: By the law `maturing`.
        published_kg: Masses by the published law.
        volumes_m3: Volumes by the law `maturing`.
        gain: By how much head and neck are heavier.
        trunk: What is left of the trunk's mass (`trunk_left`).
    """
    heads_kg = gain * published_kg["head"]
    masses = dict(published_kg)
    masses |= {geom.name: trunk * published_kg[geom.name] for geom in _geoms(anatomy, _is_trunk)}
    masses |= {geom.name: _foot_kg(geom, anatomy, volumes_m3) for geom in _geoms(anatomy, _is_foot)}
    return masses | {"head": (1 - NECK_SHARE) * heads_kg, "neck": NECK_SHARE * heads_kg}


def trunk_left(anatomy: Anatomy, published_kg: Masses, volumes_m3: Masses, gain: float) -> float:
    """Return what is left of the trunk's mass: all but what head and both feet gain.

    Args:
        anatomy: By the law `maturing`.
        published_kg: Masses by the published law, of a child without parts that its spec changes.
        volumes_m3: Volumes by the law `maturing`, likewise.
        gain: By how much head and neck are heavier.

    Raises:
        GeometryError: If too little is left.
    """
    trunk_kg = sum(published_kg[geom.name] for geom in _geoms(anatomy, _is_trunk))
    foot_kg = sum(_foot_kg(geom, anatomy, volumes_m3) - published_kg[geom.name] for geom in _geoms(anatomy, _is_foot))
    left = 1 - ((gain - 1) * published_kg["head"] + 2 * foot_kg) / trunk_kg
    if left < LEAST_TRUNK:
        raise GeometryError("this head and these feet are too heavy for a child of this weight")
    return left


def _foot_kg(figures: GeomFigures, anatomy: Anatomy, volumes_m3: Masses) -> float:
    return density(figures, anatomy.hands) * volumes_m3[figures.name]


def _is_trunk(part: Part) -> bool:
    return part.region == "trunk"


def _is_foot(part: Part) -> bool:
    return part.lies


def _geoms(anatomy: Anatomy, wanted: Callable[[Part], bool]) -> Iterator[GeomFigures]:
    """Yield the geoms of some parts of the middle and of the right side."""
    for side, part in anatomy.parts:
        if side != "left" and wanted(part):
            yield from part.geoms
