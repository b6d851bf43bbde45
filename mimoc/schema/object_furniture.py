"""What a user can ask of all furniture."""

import math
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError, Model
from mimoc.schema.object_base import ObjectSpec
from mimoc.schema.quantities import Centimetres, CyclesPerDegree, PathText, Real

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


MOST_CYCLES = 512
"""Of a grating across a picture: each takes 8 texels at least."""


class GratingSpec(Model):
    """Stripes whose brightness is a sine wave about the middle between black and white."""

    cpd: Annotated[CyclesPerDegree, Field(le=100)] = 1.0
    """Spatial frequency, in cycles per degree of the visual angle straight ahead, as seen from `from_cm`."""
    contrast: Annotated[Real, Field(ge=0, le=1)] = 1.0
    """Michelson contrast: (brightest - darkest) / (brightest + darkest); 0 is an even grey. Pictures have 256 shades:
    below 0.02, stripes are of two or three shades, and below 0.004 there are none."""
    from_cm: Annotated[Centimetres, Field(ge=5, le=500)] = 60.0
    """Viewing distance at which it has its spatial frequency."""
    stripes: Literal["vertical", "horizontal"] = "vertical"
    """How the stripes run."""

    @property
    def cycle_cm(self) -> float:
        """Length of a cycle: of one degree at the viewing distance, over the spatial frequency."""
        return self.from_cm * math.radians(1.0) / self.cpd


class PicturedSpec(FurnitureSpec):
    """Furniture that shows a picture to an infant before it, which looks along x."""

    width_cm: Side
    """Its width."""
    tall_cm: Side
    """Its height."""
    picture: PathText | None = None
    """A PNG file that it shows, relative to the folder of the spec; it is scaled down to 256 px."""
    grating: GratingSpec | None = None
    """A grating that it shows instead."""

    @model_validator(mode="after")
    def _shows_one_picture(self) -> Self:
        if self.picture is not None and self.grating is not None:
            raise KeyedError(("grating",), "it shows a picture already; leave out one of them", against=("picture",))
        return self

    @model_validator(mode="after")
    def _shows_all_stripes(self) -> Self:
        if self.grating is not None:
            across_cm = self.width_cm if self.grating.stripes == "vertical" else self.tall_cm
            if across_cm > MOST_CYCLES * self.grating.cycle_cm:
                most = MOST_CYCLES * self.grating.cycle_cm
                message = (
                    f"{across_cm:g} cm of it have more than {MOST_CYCLES} stripes; give {most:.3g} cm or less of it"
                )
                raise KeyedError(("grating", "cpd"), f"{message}, or fewer cycles per degree")
        return self
