"""A simple shape, a toy or a mesh of the user's own."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError
from mimoc.schema.kinds import ObjectKind
from mimoc.schema.objects import Distance, Material, Motion, ObjectSpec
from mimoc.schema.quantities import Centimetres, PathText, Real, Rising
from mimoc.schema.toys import ToyName, ToySize

Side = Annotated[Centimetres, Field(ge=0.5, le=300)]
Grams = Annotated[Real, Field(ge=0.1, le=100_000, json_schema_extra={"unit": "g"})]
Density = Annotated[Real, Field(ge=10, le=20_000, json_schema_extra={"unit": "kg_m3"})]
Slide = Annotated[Real, Field(ge=-100, le=100, json_schema_extra={"unit": "cm"})]
Share = Annotated[Real, Field(ge=0, le=1)]
ShapeName = Literal["sphere", "box", "cylinder", "capsule", "ellipsoid"]

SIZES = {
    "sphere": ("radius_cm",),
    "cylinder": ("radius_cm", "length_cm", "lying"),
    "capsule": ("radius_cm", "length_cm", "lying"),
    "box": ("sides_cm",),
    "ellipsoid": ("sides_cm",),
    "toy": ("size_cm", "root"),
    "mesh": ("size_cm",),
}
"""The keys that each shape has besides those of all."""
OF_MOTIONS = {"tether_cm": "hanging", "along": "sliding", "slide_cm": "sliding"}
"""The motion that each of these keys is of."""


class ShapeSpec(ObjectSpec):
    """A simple shape, a toy or a mesh of your own."""

    kind: Literal["shape"] = "shape"
    """Kind of object."""
    shape: ShapeName | None = None
    """Its shape; by default, a sphere."""
    toy: ToyName | None = None
    """Instead of a shape, one of mimoc's toys, such as `cup`, or of those in `root`."""
    root: PathText | None = None
    """Folder with Toys4K, or with other meshes, to take the `toy` from; relative to the spec's folder."""
    mesh: PathText | None = None
    """Instead of a shape, a file with a mesh (.obj, .stl, .glb or .ply), relative to the spec's folder."""
    radius_cm: Side = 3.0
    """Radius of a sphere, a cylinder or a capsule."""
    length_cm: Side = 8.0
    """Length of a cylinder or a capsule from end to end."""
    lying: Annotated[bool, Field(strict=True)] | None = None
    """Whether a cylinder or a capsule lies on its side, along its x axis; by default, capsules do that are free."""
    sides_cm: tuple[Side, Side, Side] = (6.0, 6.0, 6.0)
    """Length, breadth and height of a box or an ellipsoid."""
    size_cm: ToySize = 8.0
    """Longest side of a toy or a mesh."""
    material: Material | None = None
    """What it is made of, which also decides its density and colour unless the spec gives them; by default, plastic, or
    of a toy, what it is usually made of."""
    mass_g: Grams | None = None
    """Its mass; by default, by its density."""
    density_kg_m3: Density | None = None
    """Its mean density; by default, by its material, or that of a toy."""
    friction: Annotated[Real, Field(ge=0, le=5)] = 1.0
    """Coefficient of its sliding friction; of sliding objects, also along their axis."""
    colour: tuple[Share, Share, Share] | None = None
    """Its red, green and blue, 0 to 1; by default, by its material."""
    motion: Motion | None = None
    """How it moves: `free`; `fixed` in the world; `hanging` from a tether; `sliding` along an axis. By default, it
    hangs if it is `above` something, and is free otherwise."""
    tether_cm: Distance = 15.0
    """Of a hanging object, length of its tether: from its highest point up to where it is tied."""
    along: Literal["x", "y"] = "x"
    """Of a sliding object, the axis along which it slides, turned with it."""
    slide_cm: Annotated[tuple[Slide, Slide], Rising] = (-10.0, 10.0)
    """Of a sliding object, how far it slides from its place, backwards (not above 0) and forwards (not below 0)."""

    @property
    def source(self) -> str:
        """What it is: the name of its shape, `toy` or `mesh`."""
        return "toy" if self.toy else "mesh" if self.mesh else self.shape or "sphere"

    @property
    def moves(self) -> Motion:
        """How it moves."""
        return self.motion or ("free" if self.above is None else "hanging")

    @property
    def lies(self) -> bool:
        """Whether it lies on its side."""
        return (self.source == "capsule" and self.moves == "free") if self.lying is None else self.lying

    @property
    def carries(self) -> bool:
        """Whether other things can stand on it."""
        return self.moves != "hanging" and self.source in ("box", "cylinder", "toy", "mesh")

    def _is_unusual(self, key: str) -> bool:
        """Return whether a key has another value than its default; a spec with all defaults written out is valid."""
        return getattr(self, key) != type(self).model_fields[key].default

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        given = [key for key in ("shape", "toy", "mesh") if getattr(self, key)]
        if len(given) > 1:
            message = f"it is a {given[0]} already; keep one of 'shape', 'toy' and 'mesh'"
            raise KeyedError((given[1],), message, against=(given[0],))
        for key in ("radius_cm", "length_cm", "lying", "sides_cm", "size_cm", "root"):
            if self._is_unusual(key) and key not in SIZES[self.source]:
                usual = " and ".join(f"'{name}'" for name in SIZES[self.source])
                raise KeyedError((key,), f"a {self.source} has no '{key}'; leave it out (it has {usual})")
        if self.mass_g is not None and self.density_kg_m3 is not None:
            raise KeyedError(
                ("density_kg_m3",), "its mass is given already; leave out one of them", against=("mass_g",)
            )
        return self

    @model_validator(mode="after")
    def _moves_in_one_way(self) -> Self:
        for key, motion in OF_MOTIONS.items():
            if self._is_unusual(key) and self.moves != motion:
                raise KeyedError((key,), f"this object is not {motion}; write 'motion: {motion}', or leave this out")
        low_cm, high_cm = self.slide_cm
        if not low_cm <= 0 <= high_cm:
            raise KeyedError(("slide_cm",), "it slides from its place, 0, which is not in this range; write [-10, 10]")
        return self


KIND = ObjectKind("shape", "A simple shape.", ShapeSpec, "mimoc.components.objects.shape.build")
