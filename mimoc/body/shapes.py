"""Shapes of the parts of a child whose spec scales none of them, by either law of development."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from mimoc.body.assembly import Anatomy
from mimoc.body.density import volumes
from mimoc.body.dimensions import Dimensions
from mimoc.body.maturing.head_shape import head_dimensions
from mimoc.body.proportions import proportions
from mimoc.body.segments import body_dimensions
from mimoc.fits import Measurements
from mimoc.fits.measurements import Values

Shapes = tuple[Dimensions, Mapping[str, float]]
"""Dimensions and volumes."""


@dataclass(frozen=True, slots=True)
class Kind:
    """Which shapes a child's measurements are made into."""

    published: bool = False
    """Whether they are MIMo's, whose volumes strength and masses follow."""
    foot_height: float | None = None
    """Height of the feet by the law `maturing`, relative to MIMo's, which changes the head too; None is neither."""


MIMOS, MEASURED = Kind(published=True), Kind()


def unscaled_shapes(measurements: Measurements, side: str, anatomy: Anatomy, kind: Kind) -> Shapes:
    """Return the shapes from one side's measurements, or from both sides' if *side* is empty."""
    return _shapes(measurements.values_of(side), measurements.base_values, anatomy, kind)


@lru_cache(maxsize=16)
def _shapes(values: Values, base: Values, anatomy: Anatomy, kind: Kind) -> Shapes:
    """Return the shapes of a body; both sides of most children are the same one."""
    p = proportions(dict(values), dict(base), kind.published, kind.foot_height or 1.0)
    dimensions = body_dimensions(p, anatomy.hands)
    if kind.foot_height is not None:
        dimensions |= head_dimensions(p)
    return dimensions, volumes(anatomy, dimensions)
