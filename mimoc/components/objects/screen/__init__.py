"""A screen."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError
from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import Colour, PicturedSpec, Side
from mimoc.schema.quantities import Centimetres


class ScreenSpec(PicturedSpec):
    """A screen on a stand, across x; its picture glows, so that it looks the same in every light."""

    kind: Literal["screen"] = "screen"
    """Kind of object."""
    width_cm: Side = 50.0
    """Its width."""
    tall_cm: Side = 30.0
    """Its height."""
    middle_cm: Annotated[Centimetres, Field(ge=1, le=500)] = 50.0
    """Height of its middle above the floor."""
    colour: Colour = (0.2, 0.21, 0.23)
    """Red, green and blue of its back and its stand, 0 to 1."""

    @model_validator(mode="after")
    def _is_above_the_floor(self) -> Self:
        if self.middle_cm < self.tall_cm / 2:
            message = f"its lower half reaches below the floor; give {self.tall_cm / 2:g} cm or more"
            raise KeyedError(("middle_cm",), message, against=("tall_cm",))
        return self


KIND = ObjectKind("screen", "A screen that shows a picture.", ScreenSpec, "mimoc.components.objects.screen.build")
