"""Masses of the parts of a child.

By the published law, a geom's mass is m = rho V: its density, the same at every age, times the volume V of MIMo's solid
with the child's measurements. By the law `maturing`, head, thighs and feet are heavier at the expense of the trunk; all
other parts, and the whole body, weigh what they do by the published law.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from mimoc.anatomy.anatomy import Anatomy
from mimoc.anatomy.part import BodyGeometry, ReferenceGeom, ReferencePart
from mimoc.base.geometry.primitives import volume
from mimoc.body.origins import AGE_KEY, LAW, LAW_KEY, REFERENCE, Origin
from mimoc.body.reference import ADULT_SHARE, DECAY_MONTHS, NEWBORN_EXCESS, Reference
from mimoc.body.shapes import Shapes

NECK_SHARE = 0.08  # Share of the neck in the mass of head and neck (D).
MIN_TRUNK_SHARE = 0.4
"""Least share of its mass by the published law that a trunk keeps; it limits the heads of children far outside of WHO's
percentiles."""
THIGH = "{side}_upper_leg1"  # Name of the geom of a thigh.
TISSUE_KG_M3 = 1060.0
"""Density of a thigh by the law `maturing`: that of muscle (M). MIMo's is 790 to 950, with which thighs weigh two
thirds of what Sun & Jensen 1994 (M) found at 2 to 9 months."""

HEAD_KEY = "measurements.head_circumference_cm"
HEAD_SHARES = (
    f"such that head and neck of the average child have {ADULT_SHARE:g} + {NEWBORN_EXCESS:g} exp(-age / "
    f"{DECAY_MONTHS:g} months) of its mass (D, between Jensen 1989 and the Q dummies of UN R129, S)"
)


@dataclass(frozen=True, slots=True)
class Masses:
    """The masses of a child's geoms, and where they come from."""

    kg: Mapping[str, Mapping[str, float]]  # By side (empty for the middle), then by name with `{side}`.
    densities_kg_m3: Mapping[str, float]
    head_gain: float = 1.0  # Mass of head and neck by the law `maturing`, relative to the published law.
    feet: Collection[str] = ()  # Names of the parts of feet, which are higher by the law `maturing`.
    trunk_share: float | None = None  # Mass of the trunk relative to the published law; None by that law.

    def body_kg(self, anatomy: Anatomy) -> float:
        """Return the mass of the whole body."""
        return math.fsum(self.kg[side][geom.name] for side, part in anatomy.parts for geom in part.geoms)

    def origin(self, figures: ReferenceGeom, part: ReferencePart, name: str, sources: Sequence[str]) -> Origin:
        """Return where the mass of a geom comes from; *sources* are keys of the measurements that its size follows."""
        if origin := self._maturing_origin(figures, part, name, sources):
            return origin
        basis = f"density such that this part of the average child of 18 months has {figures.mass_kg:g} kg, as"
        if figures.mass_at_m:
            basis = "the density of"
        law = f"{self._published_text(figures)}, by the growth law of the paper"
        return Origin(f"{law}; {basis} {REFERENCE}", tuple(sources))

    def _maturing_origin(
        self, figures: ReferenceGeom, part: ReferencePart, name: str, sources: Sequence[str]
    ) -> Origin | None:
        """Return the origin of a mass that the law `maturing` changes; None of any other mass, and by another law."""
        if self.trunk_share is None:
            return None
        if part.region == "trunk":
            gives = f"by {LAW}, it gives what head, neck, thighs and feet gain (D)"
            text = f"{self._published_text(figures)} x {self.trunk_share:.6g}: {gives}"
            return Origin(text, (*sources, HEAD_KEY, AGE_KEY, LAW_KEY))
        if part.name == "head":
            share = NECK_SHARE if figures.name == "neck" else 1 - NECK_SHARE
            text = f"{share:g} x {self.head_gain:.6g} x the head's mass by the published law, {HEAD_SHARES}"
            return Origin(f"by {LAW}, {text}; the neck has {NECK_SHARE:g} of that (D)", (HEAD_KEY, AGE_KEY, LAW_KEY))
        if part.name in self.feet:
            density = self._density_text(figures)
            text = f"{density}, the density of {REFERENCE}, x volume, which by {LAW} is larger than there (D)"
            return Origin(text, (f"geom.{name}.size", LAW_KEY))
        if figures.name == THIGH:
            text = f"{TISSUE_KG_M3:g} kg/m3, the density of muscle (M), by {LAW} x volume"
            return Origin(text, (f"geom.{name}.size", LAW_KEY))
        return None

    def _density_text(self, figures: ReferenceGeom) -> str:
        return f"{self.densities_kg_m3[figures.name]:.6g} kg/m3"

    def _published_text(self, figures: ReferenceGeom) -> str:
        """Return how a mass follows from the published law."""
        return f"{self._density_text(figures)} x volume of MIMo's solid with these measurements"


def weigh_parts(shapes: Shapes, reference: Reference) -> Masses:
    """Return the masses of a child's parts, by its law of development."""
    if reference.anatomy.development == "maturing":
        return _maturing(shapes, reference)
    published_kg = shapes.of_sides(lambda side: _published_kg(reference, shapes.mimos_m3[side]))
    return Masses(published_kg, reference.densities_kg_m3)


def _maturing(shapes: Shapes, reference: Reference) -> Masses:
    """Return the published masses, of which the trunk gives what head, neck, thighs and feet gain.

    With g the gain of the head, m the published masses and f = rho V those of a leg's thigh and foot with the density
    of tissue and the height of their age, the trunk keeps the share t = 1 - ((g - 1) m_head + 2 (f - m)) / m_trunk,
    which is at least `MIN_TRUNK_SHARE`. Gain and share are those of the child before its spec changes any single part.
    """
    trunk = [geom for _, part in reference.anatomy.parts if part.region == "trunk" for geom in part.geoms]
    usual_kg = _published_kg(reference, shapes.usual_m3)
    usual_legs_kg = _legs_kg(reference, shapes.usual)
    trunk_kg = math.fsum(usual_kg[geom.name] for geom in trunk)
    leg_kg = math.fsum(kg - usual_kg[name] for name, kg in usual_legs_kg.items())
    gain = min(reference.head_gain, 1 + ((1 - MIN_TRUNK_SHARE) * trunk_kg - 2 * leg_kg) / usual_kg["head"])
    trunk_share = 1 - ((gain - 1) * usual_kg["head"] + 2 * leg_kg) / trunk_kg

    def of_side(side: str) -> dict[str, float]:
        published_kg = _published_kg(reference, shapes.mimos_m3[side])
        head_kg = gain * published_kg["head"]
        return {
            **published_kg,
            **{geom.name: trunk_share * published_kg[geom.name] for geom in trunk},
            **_legs_kg(reference, shapes.built[side]),
            "head": (1 - NECK_SHARE) * head_kg,
            "neck": NECK_SHARE * head_kg,
        }

    return Masses(
        shapes.of_sides(of_side),
        reference.densities_kg_m3,
        gain,
        {part.name for part in reference.anatomy.feet.parts},
        trunk_share,
    )


def _published_kg(reference: Reference, volumes_m3: Mapping[str, float]) -> dict[str, float]:
    """Return m = rho V of each geom."""
    return {name: kg_per_m3 * volumes_m3[name] for name, kg_per_m3 in reference.densities_kg_m3.items()}


def _legs_kg(reference: Reference, dimensions: BodyGeometry) -> dict[str, float]:
    """Return the masses f of a leg's thigh and foot, by name."""
    thighs = (geom for _, part in reference.anatomy.parts for geom in part.geoms if geom.name == THIGH)
    densities = {**reference.densities_kg_m3, THIGH: TISSUE_KG_M3}
    return {
        geom.name: densities[geom.name] * volume(geom.type, dimensions.shapes[geom.name].size_m)
        for geom in (*reference.anatomy.of_foot(), *thighs)
    }
