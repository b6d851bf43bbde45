"""A wall."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import Colour, PicturedSpec, Side
from mimoc.schema.quantities import Centimetres


class WallSpec(PicturedSpec):
    """A wall that stands on the floor, across x; a picture covers its front, in the light of the room."""

    kind: Literal["wall"] = "wall"
    """Kind of object."""
    width_cm: Side = 200.0
    """Its width."""
    tall_cm: Side = 120.0
    """Its height."""
    thickness_cm: Annotated[Centimetres, Field(ge=1, le=50)] = 5.0
    """Its thickness."""
    colour: Colour = (0.88, 0.86, 0.8)
    """Its red, green and blue, 0 to 1."""


KIND = ObjectKind("wall", "A wall, which can have a picture on it.", WallSpec, "mimoc.components.objects.wall.build")
