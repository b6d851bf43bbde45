"""Density of each geom, the same at every age.

At 18 months, each part of the average child has MIMo's mass, so a geom's density is MIMo's mass divided by the volume
of the geom in that child. Five-finger hands are the exception: they follow measured hands, with about half the volume
of MIMo's, and have the density of MIMo's hands (about 1,030 kg/m³) instead of their mass, with which fingertips would
have a density of 2,300 kg/m³. Masses and sizes are MIMo's (Mattern et al. 2024; López et al. 2025); `{side}` stands
for right and left.
"""

from collections.abc import Mapping
from functools import cache, lru_cache
from types import MappingProxyType

from mimoc.body.anatomy import REFERENCE_AGE_MONTHS
from mimoc.body.assembly import Anatomy, assemble
from mimoc.body.figures import GeomFigures
from mimoc.body.proportions import proportions
from mimoc.body.segments import Dimensions, body_dimensions
from mimoc.fits import measure
from mimoc.geometry.primitives import volume

Size = tuple[float, ...]
"""Size as in MuJoCo, in [m]."""


def density(figures: GeomFigures, hands: str) -> float:
    """Return the density of a geom, in [kg/m³]; 0 for geoms without mass.

    Args:
        figures: Reference values of the geom.
        hands: `mitten` or `five_finger`.
    """
    if not figures.mass_kg:
        return 0.0
    if is_of_fingers(figures, hands):
        return figures.mass_kg / volume(figures.type, FIVE_FINGER_HAND[figures.name])
    return figures.mass_kg / reference_volumes(hands)[figures.name]


def is_of_fingers(figures: GeomFigures, hands: str) -> bool:
    """Return whether a geom belongs to a five-finger hand, which has the density of MIMo's hand instead of its mass."""
    return hands == "five_finger" and figures.name in FIVE_FINGER_HAND


@cache
def reference_volumes(hands: str) -> Mapping[str, float]:
    """Return the volume of each of MIMo's geoms in the average child of 18 months, in m³, by its name with `{side}`.

    Args:
        hands: `mitten` or `five_finger`.
    """
    average = measure(REFERENCE_AGE_MONTHS).published
    return volumes(assemble(hands, False), body_dimensions(proportions(average, average, published=True), hands))


def volumes(anatomy: Anatomy, dimensions: Dimensions) -> dict[str, float]:
    """Return the volume of each geom by its name with `{side}`, in m³."""
    return {name: volume(figures.type, dimensions.shapes[name].size_m) for name, figures in anatomy.geoms.items()}


def masses(anatomy: Anatomy, volumes_m3: Mapping[str, float]) -> dict[str, float]:
    """Return the mass of each geom by its name with `{side}`, in kg, from their volumes."""
    return {name: kg_per_m3 * volumes_m3[name] for name, kg_per_m3 in _densities(anatomy).items()}


@lru_cache(maxsize=16)
def _densities(anatomy: Anatomy) -> Mapping[str, float]:
    """Return the density of each geom by its name with `{side}`, in [kg/m³]."""
    return MappingProxyType({name: density(figures, anatomy.hands) for name, figures in anatomy.geoms.items()})


FIVE_FINGER_HAND: Mapping[str, Size] = {
    "{side}_hand1": (0.01712, 0.00584, 0.02532),
    "{side}_hand2": (0.00588, 0.00584, 0.01292),
    "{side}_hand3": (0.00584, 0.0171),
    "{side}_hand4": (0.00584, 0.02298),
    "{side}_ffknuckle1": (0.00549, 0.00992),
    "{side}_ffmiddle1": (0.0052, 0.00501),
    "{side}_ffdistal1": (0.005, 0.00464),
    "{side}_mfknuckle1": (0.00579, 0.011),
    "{side}_mfmiddle1": (0.0054, 0.00562),
    "{side}_mfdistal1": (0.0052, 0.00538),
    "{side}_rfknuckle1": (0.00549, 0.00978),
    "{side}_rfmiddle1": (0.0052, 0.00489),
    "{side}_rfdistal1": (0.005, 0.00479),
    "{side}_lfmetacarpal1": (0.00508, 0.00584, 0.01292),
    "{side}_lfmetacarpal2": (0.00584, 0.005),
    "{side}_lfknuckle1": (0.00529, 0.00816),
    "{side}_lfmiddle1": (0.005, 0.00455),
    "{side}_lfdistal1": (0.0049, 0.00391),
    "{side}_thbase1": (0.00736, 0.01027),
    "{side}_thhub1": (0.00638, 0.00697),
    "{side}_thdistal1": (0.00618, 0.00587),
}
"""Sizes of MIMo's five-finger hand."""
