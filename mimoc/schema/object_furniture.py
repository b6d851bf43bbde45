"""What a user can ask of all furniture."""

from typing import Annotated, Self, TypeAlias

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError
from mimoc.schema.object_base import ObjectSpec
from mimoc.schema.quantities import Centimetres, Real

Side = Annotated[Centimetres, Field(ge=1, le=500)]
Share = Annotated[Real, Field(ge=0, le=1)]
Colour: TypeAlias = tuple[Share, Share, Share]
WOOD: Colour = (0.82, 0.66, 0.46)
CLOTH: Colour = (0.36, 0.52, 0.6)


class FurnitureSpec(ObjectSpec):
    """Furniture, which stands on the floor and does not move."""

    @property
    def carries(self) -> bool:
        """Whether other things can stand on it."""
        return True

    @model_validator(mode="after")
    def _stands(self) -> Self:
        if self.above is not None:
            raise KeyedError(("above",), "furniture stands on the floor; give its place with 'at'")
        return self
