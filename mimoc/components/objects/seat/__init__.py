"""A seat that fits the infant."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.body import PartName
from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import CLOTH, Colour, FurnitureSpec
from mimoc.schema.quantities import Centimetres, Degrees


class SeatSpec(FurnitureSpec):
    """A seat that fits the infant: a back to lean on, a bottom, and a board on either side of the hips."""

    kind: Literal["seat"] = "seat"
    """Kind of object."""
    recline_deg: Annotated[Degrees, Field(ge=15, le=60)] = 30.0
    """How far the back leans from the vertical. The bottom is tilted up in front by half as much."""
    seat_cm: Annotated[Centimetres, Field(ge=5, le=120)] | None = None
    """Height of the front edge of the bottom above the floor; by default, the feet are 3 cm above the floor."""
    belt: PartName | None = None
    """Part of the infant that a belt fixes where it starts, such as `hip` or `chest`; by default, none."""
    colour: Colour = CLOTH
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind(
    "seat",
    "A seat that fits the infant.",
    SeatSpec,
    "mimoc.components.objects.seat.build",
    start="mimoc.components.objects.seat.build",
    poses=("sitting",),
)
