"""Still water of some depth."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import Colour, FurnitureSpec, Side
from mimoc.schema.quantities import Centimetres, Real


class WaterSpec(FurnitureSpec):
    """A block of still water without walls, in which an infant can lie, sit and stand on the floor."""

    kind: Literal["water"] = "water"
    """Kind of object."""
    sides_cm: tuple[Side, Side] = (120.0, 80.0)
    """Its length, along the infant that lies in it, and its breadth."""
    depth_cm: Annotated[Centimetres, Field(ge=1, le=200)] = 20.0
    """Height of its surface above its bottom."""
    infant_kg_m3: Annotated[Real, Field(ge=800, le=1200, json_schema_extra={"unit": "kg/m3"})] = 980.0
    """Density of the infant, the same in all its parts, by which it floats or sinks; an assumption."""
    colour: Colour = (0.45, 0.72, 0.86)
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind(
    "water",
    "Still water of some depth, which lifts and slows what is in it.",
    WaterSpec,
    "mimoc.components.objects.water.build",
    start="mimoc.components.objects.water.build",
    poses=("supine", "prone", "sitting", "standing"),
    run="mimoc.components.objects.water.run",
)
