"""Height of the feet by age, from their mass."""

import math
from dataclasses import replace
from functools import cache, lru_cache

from mimoc.body.assembly import assemble
from mimoc.body.density import density
from mimoc.body.figures import GeomFigures
from mimoc.body.proportions import proportions
from mimoc.body.segments import FEET
from mimoc.fits import measure
from mimoc.geometry.primitives import volume

NEWBORN_KG, KG_PER_MONTH = 0.062, 0.0075
"""Mass of a foot by age: .062 kg at birth, .197 kg at 18 months (M).

It is the mean of two regressions, Sun & Jensen 1994 (.0522 + .00212 weeks) and Schneider & Zernicke 1992 (.0029 mass +
1.24 length / 100 + 1.93 breadth / 100 - .1025; kg, cm), which are up to .08 kg apart."""
PRECISION = 1e-12
"""Of a relative height, so that no digit in a file depends on the search for it."""


def foot_mass_kg(age_months: float) -> float:
    """Return the mass of a foot with its toes, of the average child of an age."""
    return NEWBORN_KG + KG_PER_MONTH * age_months


@lru_cache(maxsize=64)
def foot_height(age_months: float, hands: str) -> float:
    """Return the height of the feet of an age relative to MIMo's, at which the average child's have their mass.

    Length, breadth and density are those of the published body. The mass is so nearly in proportion to the height that
    the secant method needs a few steps.

    Args:
        age_months: Age of the infant.
        hands: `mitten` or `five_finger`; the toes differ.
    """
    average, wanted_kg = dict(measure(age_months)), foot_mass_kg(age_months)
    p = proportions(average, average)

    def excess_kg(height: float) -> float:
        foot = replace(p.foot, half_height_m=height * p.foot.half_height_m)
        shapes = FEET[hands](replace(p, foot=foot)).shapes
        parts = ((figures, kg_per_m3, shapes[figures.name].size_m) for figures, kg_per_m3 in _feet(hands))
        return math.fsum(kg_per_m3 * volume(figures.type, size_m) for figures, kg_per_m3, size_m in parts) - wanted_kg

    before, now = 1.5, 1.6
    before_kg, now_kg = excess_kg(before), excess_kg(now)
    while abs(now - before) > PRECISION and now_kg != before_kg:
        before, now = now, now - now_kg * (now - before) / (now_kg - before_kg)
        before_kg, now_kg = now_kg, excess_kg(now)
    return now


@cache
def _feet(hands: str) -> tuple[tuple[GeomFigures, float], ...]:
    """Return the geoms of a foot with its toes, with their densities in kg/m³."""
    parts = (part for side, part in assemble(hands, False).parts if side == "right" and part.lies)
    return tuple((geom, density(geom, hands)) for part in parts for geom in part.geoms)
