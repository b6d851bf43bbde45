"""Mass of head and neck by age."""

import math
from functools import lru_cache

from mimoc.body.assembly import assemble
from mimoc.body.density import masses
from mimoc.body.shapes import MIMOS, unscaled_shapes
from mimoc.fits import measure

ADULT_SHARE, NEWBORN_EXCESS, DECAY_MONTHS = 0.20, 0.10, 18.0
"""Share of the body's mass in head and neck: .300 at birth, .272 at 6 months, .251 at 12, .237 at 18 (D), between the Q
dummies of UN R129 (Q0 .326, Q1 .251, Q1.5 .252; S), Jensen 1989 (S, extrapolated below 4 years: .279 at birth, .258 at
a year) and an adult's head scaled by its circumference (M); .03 either way covers them."""


def head_share(age_months: float) -> float:
    """Return the share of head and neck in the mass of the average child of an age."""
    return ADULT_SHARE + NEWBORN_EXCESS * math.exp(-age_months / DECAY_MONTHS)


@lru_cache(maxsize=64)
def head_gain(age_months: float, hands: str) -> float:
    """Return by how much head and neck are heavier than in the published body of the same age."""
    average, anatomy = measure(age_months).published, assemble(hands, False)
    _, volumes_m3 = unscaled_shapes(average, "", anatomy, MIMOS)
    published_kg = masses(anatomy, volumes_m3)
    body_kg = math.fsum(published_kg[geom.name] for _, part in anatomy.parts for geom in part.geoms)
    return head_share(age_months) * body_kg / published_kg["head"]
