"""A rail to hold on to."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import WOOD, Colour, FurnitureSpec, Side
from mimoc.schema.quantities import Centimetres


class RailSpec(FurnitureSpec):
    """A bar across two posts, at which an infant can stand and hold on."""

    kind: Literal["rail"] = "rail"
    """Kind of object."""
    width_cm: Side = 80.0
    """From post to post."""
    bar_cm: Annotated[Centimetres, Field(ge=5, le=100)] | None = None
    """Height of the middle of the bar above the floor; by default, as high for the child as the rail of its crib."""
    grip: bool = True
    """Whether the hands of an infant that starts at it hold on: they are fixed to the bar, and turn about it."""
    colour: Colour = WOOD
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind(
    "rail",
    "A bar across two posts, to hold on to.",
    RailSpec,
    "mimoc.components.objects.rail.build",
    start="mimoc.components.objects.rail.build",
    poses=("standing",),
)
