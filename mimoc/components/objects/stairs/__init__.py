"""Stairs."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import WOOD, Colour, FurnitureSpec, Side
from mimoc.schema.quantities import Centimetres, Whole


class StairsSpec(FurnitureSpec):
    """Stairs that lead up along x."""

    kind: Literal["stairs"] = "stairs"
    """Kind of object."""
    steps: Annotated[Whole, Field(ge=1, le=20)] = 3
    """Number of steps."""
    rise_cm: Annotated[Centimetres, Field(ge=1, le=30)] = 10.0
    """Height of each step above the one before."""
    run_cm: Annotated[Centimetres, Field(ge=5, le=100)] = 20.0
    """Depth of each step."""
    width_cm: Side = 60.0
    """Their width."""
    colour: Colour = WOOD
    """Their red, green and blue, 0 to 1."""


KIND = ObjectKind("stairs", "Stairs.", StairsSpec, "mimoc.components.objects.stairs.build")
