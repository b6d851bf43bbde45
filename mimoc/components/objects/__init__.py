"""Objects in the infant's scene: what a user can ask of shapes, mobiles and furniture."""

from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, JsonValue, model_validator

from mimoc.schema.base import KeyedError
from mimoc.schema.body import PartName
from mimoc.schema.kinds import ObjectKind
from mimoc.schema.objects import (
    CLOTH,
    WOOD,
    Colour,
    Distance,
    FurnitureSpec,
    Material,
    Motion,
    ObjectSpec,
    PicturedSpec,
    Side,
    ToyName,
    ToySize,
)
from mimoc.schema.quantities import Centimetres, Degrees, PathText, Real, Rising, Whole

Edge = Annotated[Centimetres, Field(ge=0.5, le=300)]
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
    radius_cm: Edge = 3.0
    """Radius of a sphere, a cylinder or a capsule."""
    length_cm: Edge = 8.0
    """Length of a cylinder or a capsule from end to end."""
    lying: Annotated[bool, Field(strict=True)] | None = None
    """Whether a cylinder or a capsule lies on its side, along its x axis; by default, capsules do that are free."""
    sides_cm: tuple[Edge, Edge, Edge] = (6.0, 6.0, 6.0)
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


SHAPE = ObjectKind("shape", "A simple shape.", ShapeSpec, "mimoc.components.objects.shape")


Limb = Literal["right_foot", "left_foot", "right_hand", "left_hand"]
Figure = Literal[
    "airplane", "ball", "boat", "bunny", "bus", "car", "chicken", "elephant", "fish", "penguin", "pig", "whale"
]
"""The toys of mimoc's whose sides are worth looking at."""


COUNT: dict[str, JsonValue] = {"minItems": 2, "maxItems": 8}  # How many figures: one alone would pull the mobile askew.


def _counted(figures: Sequence[str]) -> Sequence[str]:
    if not 2 <= len(figures) <= 8:
        raise ValueError(f"a mobile with {len(figures)} of them does not hang well; name 2 to 8 figures")
    return figures


class MobileSpec(ObjectSpec):
    """A mobile whose figures swing about a bell, with a ribbon that can be tied to a hand or a foot."""

    kind: Literal["mobile"]
    """Kind of object."""
    figures: Annotated[tuple[Figure, ...], AfterValidator(_counted), Field(json_schema_extra=COUNT)] = (
        "fish",
        "bunny",
        "whale",
        "chicken",
    )
    """Its figures, 2 to 8, by names of mimoc's toys; each hangs from an arm, its side downwards."""
    size_cm: Annotated[Centimetres, Field(ge=3, le=12)] = 6.0
    """Longest side of a figure."""
    figure_g: Annotated[Real, Field(ge=5, le=200, json_schema_extra={"unit": "g"})] = 15.0
    """Mass of a figure."""
    arm_cm: Annotated[Centimetres, Field(ge=5, le=40)] | None = None
    """Length of an arm, from the middle; by default, and at least, as long as the figures and the bell need room."""
    cord_cm: Annotated[Centimetres, Field(ge=5, le=200)] = 30.0
    """Length of the cord that it hangs from."""
    tied_to: Limb | None = None
    """The foot or the hand that its ribbon is tied to, at the ankle or the wrist; by default, it has none."""
    slack_cm: Annotated[Real, Field(ge=0, le=50, json_schema_extra={"unit": "cm"})] = 0.5
    """By how much the ribbon is longer than its way as the infant starts."""


MOBILE = ObjectKind(
    "mobile",
    "A mobile whose figures swing about a bell, with a ribbon that can be tied to a hand or a foot.",
    MobileSpec,
    "mimoc.components.objects.mobile",
)


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


MAT = ObjectKind(
    "mat",
    "A soft mat on the floor.",
    MatSpec,
    "mimoc.components.objects.furniture:build_mat",
    start="mimoc.components.objects.furniture:start_mat",
    poses=("supine", "prone", "sitting", "standing"),
)


class SeatSpec(FurnitureSpec):
    """A seat that fits the infant: a back to lean on, a bottom, and a board on either side of the hips."""

    kind: Literal["seat"] = "seat"
    """Kind of object."""
    recline_deg: Annotated[Degrees, Field(ge=15, le=60)] = 30.0
    """How far the back leans from the vertical. The bottom is tilted up in front by half as much."""
    seat_cm: Annotated[Centimetres, Field(ge=5, le=120)] | None = None
    """Height of the front edge of the bottom above the floor; by default, the feet are 3 cm above the floor."""
    belt: PartName | None = None
    """Part of the infant that a belt fixes where it starts, such as `hip` or `chest`; by default, none."""
    colour: Colour = CLOTH
    """Its red, green and blue, 0 to 1."""


SEAT = ObjectKind(
    "seat",
    "A seat that fits the infant.",
    SeatSpec,
    "mimoc.components.objects.seat",
    start="mimoc.components.objects.seat",
    poses=("sitting",),
)


class RailSpec(FurnitureSpec):
    """A bar across two posts, at which an infant can stand and hold on."""

    kind: Literal["rail"] = "rail"
    """Kind of object."""
    width_cm: Side = 80.0
    """From post to post."""
    bar_cm: Annotated[Centimetres, Field(ge=5, le=100)] | None = None
    """Height of the middle of the bar above the floor; by default, as high for the child as the rail of its crib."""
    grip: bool = True
    """Whether the hands of an infant that starts at it hold on: they are fixed to the bar, and turn about it."""
    colour: Colour = WOOD
    """Its red, green and blue, 0 to 1."""


RAIL = ObjectKind(
    "rail",
    "A bar across two posts, to hold on to.",
    RailSpec,
    "mimoc.components.objects.furniture:build_rail",
    start="mimoc.components.objects.furniture:start_rail",
    poses=("standing",),
)


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


TABLE = ObjectKind(
    "table",
    "A table with four legs.",
    TableSpec,
    "mimoc.components.objects.furniture:build_table",
    start="mimoc.components.objects.furniture:start_table",
    poses=("standing",),
)


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


STAIRS = ObjectKind("stairs", "Stairs.", StairsSpec, "mimoc.components.objects.furniture:build_stairs")


class SlopeSpec(FurnitureSpec):
    """A board that leads up along x, on which an infant can lie."""

    kind: Literal["slope"] = "slope"
    """Kind of object."""
    angle_deg: Annotated[Degrees, Field(ge=0, le=40)] = 15.0
    """Of its top above the horizontal."""
    length_cm: Side = 120.0
    """Of its top, from the floor upwards."""
    width_cm: Side = 80.0
    """Its width."""
    colour: Colour = WOOD
    """Its red, green and blue, 0 to 1."""


SLOPE = ObjectKind(
    "slope",
    "A board that leads up.",
    SlopeSpec,
    "mimoc.components.objects.furniture:build_slope",
    start="mimoc.components.objects.furniture:start_slope",
    poses=("supine", "prone"),
)


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


WALL = ObjectKind(
    "wall", "A wall, which can have a picture on it.", WallSpec, "mimoc.components.objects.furniture:build_wall"
)


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


SCREEN = ObjectKind(
    "screen", "A screen that shows a picture.", ScreenSpec, "mimoc.components.objects.furniture:build_screen"
)


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


WATER = ObjectKind(
    "water",
    "Still water of some depth, which lifts and slows what is in it.",
    WaterSpec,
    "mimoc.components.objects.furniture:build_water",
    start="mimoc.components.objects.furniture:start_water",
    poses=("supine", "prone", "sitting", "standing"),
    run="mimoc.components.objects.water",
)
