"""A soft mat to lie on."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import Colour, FurnitureSpec, Side
from mimoc.schema.quantities import Centimetres


class MatSpec(FurnitureSpec):
    """A soft mat on the floor, on which an infant can lie, sit and stand."""

    kind: Literal["mat"] = "mat"
    """Kind of object."""
    sides_cm: tuple[Side, Side] = (120.0, 100.0)
    """Its length, along the infant that lies on it, and its breadth."""
    thickness_cm: Annotated[Centimetres, Field(ge=0.5, le=50)] = 3.0
    """Its thickness."""
    sink_cm: Annotated[Centimetres, Field(ge=0.05, le=3)] = 0.5
    """How deep something sinks in that rests on one point of it; the mattress of a crib has about 0.7."""
    colour: Colour = (0.62, 0.75, 0.72)
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind(
    "mat",
    "A soft mat on the floor.",
    MatSpec,
    "mimoc.components.objects.mat.build",
    start="mimoc.components.objects.mat.build",
    poses=("supine", "prone", "sitting", "standing"),
)
