"""Masses by the law `maturing`: heavier head and feet, at the expense of the trunk.

All other parts weigh what they do by the published law, and so does the whole body.
"""

import math
from collections.abc import Mapping
from functools import lru_cache

from mimoc.body.assembly import Anatomy
from mimoc.body.density import density
from mimoc.body.figures import GeomFigures

NECK_SHARE = 0.08
"""Of the neck in the mass of head and neck (D)."""
LEAST_TRUNK = 0.4
"""Of its mass by the published law, which a trunk keeps in any case; it limits the heads of children far outside of
WHO's percentiles."""

Masses = Mapping[str, float]
"""In kg, by name of the geom with `{side}`."""


def matured_masses(anatomy: Anatomy, published_kg: Masses, volumes_m3: Masses, gain: float, trunk: float) -> Masses:
    """Return the masses of one side's and the middle's geoms.

    Args:
        anatomy: By the law `maturing`.
        published_kg: Masses by the published law.
        volumes_m3: Volumes by the law `maturing`.
        gain: By how much head and neck are heavier.
        trunk: What is left of the trunk's mass (`share_out`).
    """
    heads_kg = gain * published_kg["head"]
    masses = dict(published_kg)
    masses |= {geom.name: trunk * published_kg[geom.name] for geom in _trunk(anatomy)}
    masses |= {geom.name: _foot_kg(geom, anatomy, volumes_m3) for geom in _feet(anatomy)}
    return masses | {"head": (1 - NECK_SHARE) * heads_kg, "neck": NECK_SHARE * heads_kg}


def share_out(anatomy: Anatomy, published_kg: Masses, volumes_m3: Masses, gain: float) -> tuple[float, float]:
    """Return by how much head and neck are heavier, and what is left of the trunk's mass.

    That is all but what head and both feet gain. Where too little would be left, the head gains less.

    Args:
        anatomy: By the law `maturing`.
        published_kg: Masses by the published law, of a child without parts that its spec changes.
        volumes_m3: Volumes by the law `maturing`, likewise.
        gain: By how much head and neck of the average child are heavier.
    """
    trunk_kg = math.fsum(published_kg[geom.name] for geom in _trunk(anatomy))
    foot_kg = math.fsum(_foot_kg(geom, anatomy, volumes_m3) - published_kg[geom.name] for geom in _feet(anatomy))
    gain = min(gain, 1 + ((1 - LEAST_TRUNK) * trunk_kg - 2 * foot_kg) / published_kg["head"])
    return gain, 1 - ((gain - 1) * published_kg["head"] + 2 * foot_kg) / trunk_kg


def _foot_kg(figures: GeomFigures, anatomy: Anatomy, volumes_m3: Masses) -> float:
    return density(figures, anatomy.hands) * volumes_m3[figures.name]


@lru_cache(maxsize=16)
def _trunk(anatomy: Anatomy) -> tuple[GeomFigures, ...]:
    """Return the geoms of the trunk."""
    return tuple(geom for _, part in anatomy.parts if part.region == "trunk" for geom in part.geoms)


@lru_cache(maxsize=16)
def _feet(anatomy: Anatomy) -> tuple[GeomFigures, ...]:
    """Return the geoms of the right foot."""
    return tuple(geom for side, part in anatomy.parts if side != "left" and part.lies for geom in part.geoms)
