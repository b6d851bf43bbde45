"""A slope."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import WOOD, Colour, FurnitureSpec, Side
from mimoc.schema.quantities import Degrees


class SlopeSpec(FurnitureSpec):
    """A board that leads up along x, on which an infant can lie."""

    kind: Literal["slope"] = "slope"
    """Kind of object."""
    angle_deg: Annotated[Degrees, Field(ge=0, le=40)] = 15.0
    """Of its top above the horizontal."""
    length_cm: Side = 120.0
    """Of its top, from the floor upwards."""
    width_cm: Side = 80.0
    """Its width."""
    colour: Colour = WOOD
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind(
    "slope",
    "A board that leads up.",
    SlopeSpec,
    "mimoc.components.objects.slope.build",
    start="mimoc.components.objects.slope.build",
    poses=("supine", "prone"),
)
