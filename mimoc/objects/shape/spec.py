"""What a user can ask of a simple shape."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.objects.spec_base import Distance, Material, Motion, ObjectSpec
from mimoc.schema.base import KeyedError
from mimoc.schema.quantities import Centimetres, Real

Side = Annotated[Centimetres, Field(ge=0.2, le=300)]
Grams = Annotated[Real, Field(gt=0, le=100_000, json_schema_extra={"unit": "g"})]
Density = Annotated[Real, Field(ge=1, le=20_000, json_schema_extra={"unit": "kg_m3"})]
Share = Annotated[Real, Field(ge=0, le=1)]

SIZES = {
    "sphere": ("radius_cm",),
    "cylinder": ("radius_cm", "length_cm"),
    "capsule": ("radius_cm", "length_cm"),
    "box": ("sides_cm",),
    "ellipsoid": ("sides_cm",),
}
"""The keys of the size of each shape."""


class ShapeSpec(ObjectSpec):
    """A simple shape."""

    kind: Literal["shape"] = "shape"
    """Kind of object."""
    shape: Literal["sphere", "box", "cylinder", "capsule", "ellipsoid"] = "sphere"
    """Its shape."""
    radius_cm: Side | None = None
    """Radius of a sphere, a cylinder or a capsule."""
    length_cm: Side | None = None
    """Length of a cylinder or a capsule from end to end, along the vertical unless it lies."""
    sides_cm: tuple[Side, Side, Side] | None = None
    """Length, breadth and height of a box or an ellipsoid."""
    material: Material = "plastic"
    """What it is made of, which is also its density unless the spec gives that or its mass."""
    mass_g: Grams | None = None
    """Its mass."""
    density_kg_m3: Density | None = None
    """Its mean density."""
    friction: Annotated[Real, Field(ge=0, le=5)] = 1.0
    """Its coefficient of sliding friction."""
    colour: tuple[Share, Share, Share] = (0.85, 0.16, 0.12)
    """Its red, green and blue, 0 to 1."""
    motion: Motion | None = None
    """How it moves: `free`; `fixed` in the world; `hanging` from a tether; `sliding` along an axis. By default, it
    hangs if it is `above` something, and is free otherwise."""
    tether_cm: Distance = 15.0
    """Of a hanging object, the length of its tether, from its highest point up to where it is tied."""

    @model_validator(mode="after")
    def _has_its_size(self) -> Self:
        for key in ("radius_cm", "length_cm", "sides_cm"):
            if (getattr(self, key) is not None) != (key in SIZES[self.shape]):
                what = "has no such size; leave it out" if key not in SIZES[self.shape] else f"needs '{key}'; add it"
                raise KeyedError((key,), f"a {self.shape} {what}", against=("shape",))
        return self
