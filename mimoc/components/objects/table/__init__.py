"""A table."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import WOOD, Colour, FurnitureSpec, Side
from mimoc.schema.quantities import Centimetres


class TableSpec(FurnitureSpec):
    """A table with four legs, at which an infant can stand."""

    kind: Literal["table"] = "table"
    """Kind of object."""
    sides_cm: tuple[Side, Side] = (50.0, 80.0)
    """Its depth, away from an infant before it, and its width."""
    top_cm: Annotated[Centimetres, Field(ge=5, le=120)] = 40.0
    """Height of its top above the floor."""
    colour: Colour = WOOD
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind(
    "table",
    "A table with four legs.",
    TableSpec,
    "mimoc.components.objects.table.build",
    start="mimoc.components.objects.table.build",
    poses=("standing",),
)
