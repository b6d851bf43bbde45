"""The average child of 18 months, to whom masses and strength are relative, and what is known of that of each age.

At 18 months, each part of the average child has MIMo's mass, so that a geom's density, the same at every age, is

    rho = m / V_18

with MIMo's mass m of the geom and the volume V_18 of MIMo's solid with the measurements of that child. Five-finger
hands are the exception: they follow measured hands, with about half the volume of MIMo's, and have the density of
MIMo's hands (about 1,030 kg/m³) instead of their mass, with which fingertips would have a density of 2,300 kg/m³.
Masses and sizes are MIMo's (Mattern et al. 2024; López et al. 2025).
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from operator import or_

from mimoc.anatomy.anatomy import Anatomy
from mimoc.anatomy.part import REFERENCE_AGE_MONTHS, BodyGeometry, Development, PartKind
from mimoc.anatomy.parts import check_dimensions
from mimoc.anatomy.segments import Proportions, proportions
from mimoc.base.geometry.primitives import volume
from mimoc.base.kinds import function_of
from mimoc.body.published import FORMULAS
from mimoc.fits import Curves, Measurements, measure

HEIGHT = "crown_sole_length"
CURVES: Mapping[Development, Curves] = {"maturing": "count", "published": "published"}
"""The growth curves that a body's measurements follow."""

ADULT_SHARE, NEWBORN_EXCESS, DECAY_MONTHS = 0.20, 0.10, 18.0
"""Share of the body's mass in head and neck: .300 at birth, .272 at 6 months, .251 at 12, .237 at 18 (D), between the Q
dummies of UN R129 (Q0 .326, Q1 .251, Q1.5 .252; S), Jensen 1989 (S, extrapolated below 4 years: .279 at birth, .258 at
a year) and an adult's head scaled by its circumference (M); .03 either way covers them."""

NEWBORN_KG, KG_PER_MONTH = 0.062, 0.0075
"""Mass of a foot by age: .062 kg at birth, .197 kg at 18 months (M).

It is the mean of two regressions, Sun & Jensen 1994 (.0522 + .00212 weeks) and Schneider & Zernicke 1992 (.0029 mass +
1.24 length / 100 + 1.93 breadth / 100 - .1025; kg, cm), which are up to .08 kg apart."""
PRECISION = 1e-12  # Precision of a relative height, such that no digit in a file depends on the search for it.


@dataclass(frozen=True, slots=True)
class Reference:
    """What children of an anatomy and an age are compared with: the average children of 18 months and of that age."""

    anatomy: Anatomy
    volumes_m3: Mapping[str, float]
    """At which motors have MIMo's torques, by geom with `{side}`: of MIMo's geoms at 18 months; by the published law,
    of the reference body's, which are not quite those of that age."""
    densities_kg_m3: Mapping[str, float]  # Densities of the same geoms; 0 for geoms without mass.
    length_m: float
    age_months: float
    head_gain: float = 1.0
    """Mass of head and neck of the average child of that age by the law `maturing`, relative to the published law."""
    foot_height: float = 1.0  # Height of its feet, likewise.

    def at(self, age_months: float) -> "Reference":
        """Return what children of another age are compared with."""
        same = replace(self, age_months=age_months)
        if self.anatomy.development == "published":
            return same
        # Head and neck are heavier by this than in the published body of the same age.
        average = measure(same.age_months).paper_law
        anatomy = same.anatomy
        volumes_m3 = mimos_volumes(mimos_dimensions(average, "", anatomy.kinds), anatomy)
        published_kg = {name: kg_m3 * volumes_m3[name] for name, kg_m3 in same.densities_kg_m3.items()}
        body_kg = math.fsum(published_kg[geom.name] for _, part in anatomy.childs_parts for geom in part.geoms)
        return replace(
            same, head_gain=head_share(same.age_months) * body_kg / published_kg["head"], foot_height=_foot_height(same)
        )


def reference_body(anatomy: Anatomy, age_months: float) -> Reference:
    """Return what children of an anatomy and an age are compared with; KindError if a shape says too little."""
    is_published = anatomy.development == "published"
    average = measure(REFERENCE_AGE_MONTHS, CURVES[anatomy.development]).paper_law
    kinds = [kind for kind in anatomy.kinds if not (is_published and kind.name in FORMULAS)]
    dimensions = mimos_dimensions(average, "", kinds)
    for kind in kinds:
        check_dimensions(kind, dimensions)
    mimos_m3 = {name: volume(geom.type, geom.mass_at_m) for name, geom in anatomy.geoms.items() if geom.mass_at_m}
    volumes_m3 = mimos_volumes(dimensions, anatomy) | (mimos_m3 if is_published else {})
    densities_kg_m3 = {
        name: figures.mass_kg / mimos_m3.get(name, volumes_m3[name]) for name, figures in anatomy.geoms.items()
    }
    return Reference(anatomy, volumes_m3, densities_kg_m3, average[HEIGHT], REFERENCE_AGE_MONTHS).at(age_months)


def dimensions_of(p: Proportions, kinds: Iterable[PartKind]) -> BodyGeometry:
    """Return the dimensions of some kinds of parts; raise a GeometryError if a segment is wider than it is long."""
    return reduce(or_, (function_of(kind.shape, "shape")(p) for kind in kinds), BodyGeometry())


def mimos_dimensions(child: Measurements, side: str, kinds: Iterable[PartKind]) -> BodyGeometry:
    """Return MIMo's shapes with the measurements of one side of a child, or of both sides if *side* is empty."""
    return dimensions_of(proportions(child.of_side(side), child.base_m, mimos=True), kinds)


def mimos_volumes(dimensions: BodyGeometry, anatomy: Anatomy) -> dict[str, float]:
    """Return the volumes of MIMo's solids of some dimensions, by geom with `{side}`, in m³."""
    return {
        name: volume(geom.type, dimensions.shapes[name].size_m)
        for name, geom in anatomy.geoms.items()
        if name in dimensions.shapes
    }


def head_share(age_months: float) -> float:
    """Return the share of head and neck in the mass of the average child: .20 + .10 exp(-age / 18 months)."""
    return ADULT_SHARE + NEWBORN_EXCESS * math.exp(-age_months / DECAY_MONTHS)


def _foot_height(reference: Reference) -> float:
    """Return the height of the feet of an age relative to MIMo's, at which the average child's have their mass.

    Length, breadth and density are those of the published body. The mass is so nearly in proportion to the height that
    the secant method needs a few steps.
    """
    average = dict(measure(reference.age_months))
    wanted_kg = NEWBORN_KG + KG_PER_MONTH * reference.age_months
    p, anatomy = proportions(average, average), reference.anatomy

    def excess_kg(height: float) -> float:
        foot = replace(p.foot, half_height_m=height * p.foot.half_height_m)
        shapes = dimensions_of(replace(p, foot=foot), (anatomy.feet,)).shapes
        parts = ((geom, reference.densities_kg_m3[geom.name], shapes[geom.name].size_m) for geom in anatomy.of_foot())
        return math.fsum(kg_per_m3 * volume(geom.type, size_m) for geom, kg_per_m3, size_m in parts) - wanted_kg

    before, now = 1.5, 1.6
    before_kg, now_kg = excess_kg(before), excess_kg(now)
    while abs(now - before) > PRECISION and now_kg != before_kg:
        before, now = now, now - now_kg * (now - before) / (now_kg - before_kg)
        before_kg, now_kg = now_kg, excess_kg(now)
    return now
