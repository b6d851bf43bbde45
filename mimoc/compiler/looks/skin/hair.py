"""The hair of a child of any age: a layer over the scalp, which grows. Its picture shows the more hair, the higher."""

from typing import NamedTuple

import numpy as np

from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.geometry.smoothstep import smoothstep
from mimoc.base.geometry.triangles import normals_of
from mimoc.compiler.looks.skin.template_mesh import SculptedHair


class Growth(NamedTuple):
    """The hair of one age; all figures are chosen by eye (D)."""

    months: float
    cover: float
    """How much of the scalp it covers, 0 to 1."""
    thick_mm: float
    """How thick it lies, on a head of nine months."""
    edge_deg: float
    """Within how much of the hairline it becomes as dense as that."""
    fringe: float
    """How much of a fringe there is, 0 to 1."""
    worn: float
    """How much of it is rubbed off at the back of the head, 0 to 1."""


GROWTH = (
    Growth(0, 0.22, 0.6, 12, 0.0, 0.0),
    Growth(3, 0.29, 0.7, 12, 0.0, 0.65),
    Growth(6, 0.42, 1.0, 12, 0.1, 0.50),
    Growth(9, 0.63, 1.7, 12, 0.25, 0.15),
    Growth(12, 0.82, 2.6, 12, 0.45, 0.0),
    Growth(18, 0.95, 4.6, 12, 0.8, 0.0),
    Growth(24, 1.0, 6.5, 12, 1.0, 0.0),
)
BARE, CLEAR = 0.05, 0.11
"""Up to the first share of hair the layer is under the skin, and from the second on it is above it; up to there, its
picture is skin."""
SUNK_MM, LEAST_MM = 0.9, 0.4
"""How deep and how high it is there."""
MARGIN = 0.06
"""Of the picture, which is repeated beyond its borders, so that what is far away looks a little like both."""


def hair_over(
    sculpted: SculptedHair, verts_m: FloatArray, age_months: float, size: float
) -> tuple[FloatArray, FloatArray]:
    """Return the vertices of the hair and their places in its picture, shapes (n, 3) and (n, 2), [m].

    Args:
        sculpted: The scalp.
        verts_m: Vertices of the head, in any frame.
        age_months: Age of the child.
        size: Of the head, by that of nine months.
    """
    share = density(sculpted, age_months)
    growth = growth_at(age_months)
    full = smoothstep(share / max(growth.cover, 1e-9))
    height_mm = LEAST_MM + (growth.thick_mm - LEAST_MM) * full
    above = smoothstep((share - BARE) / (CLEAR - BARE))
    height_m = size * (above * height_mm - (1 - above) * SUNK_MM) / 1000
    scalp_m = verts_m[sculpted.verts]
    outward = normals_of(scalp_m, sculpted.faces)
    places = MARGIN + (1 - 2 * MARGIN) * np.column_stack((sculpted.around, share))
    return scalp_m + height_m[:, None] * outward, places


def density(sculpted: SculptedHair, age_months: float) -> FloatArray:
    """Return how much hair there is at each vertex of the scalp, 0 to 1, shape (n,)."""
    growth = growth_at(age_months)
    within = sculpted.inside_deg[:, 0] + growth.fringe * sculpted.inside_deg[:, 1]
    return growth.cover * smoothstep(within / growth.edge_deg) * (1 - growth.worn * sculpted.worn)


def growth_at(age_months: float) -> Growth:
    """Return the hair of an age, between those of `GROWTH`.

    Example:
        >>> from mimoc.compiler.looks.skin.hair import growth_at
        >>> growth_at(24).cover
        1.0
    """
    table = np.array(GROWTH)
    return Growth(*(float(np.interp(age_months, table[:, 0], column)) for column in table.T))
