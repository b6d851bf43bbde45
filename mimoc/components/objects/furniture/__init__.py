"""Furniture, which stands on the floor and does not move: what a user can ask of each kind."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError
from mimoc.schema.body import PartName
from mimoc.schema.kinds import ObjectKind
from mimoc.schema.objects import CLOTH, WOOD, Colour, FurnitureSpec, PicturedSpec, Side
from mimoc.schema.quantities import Centimetres, Degrees, Real, Whole


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
    "mimoc.components.objects.furniture.build:build_mat",
    start="mimoc.components.objects.furniture.build:start_mat",
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
    "mimoc.components.objects.furniture.seat",
    start="mimoc.components.objects.furniture.seat",
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
    "mimoc.components.objects.furniture.rail",
    start="mimoc.components.objects.furniture.rail",
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
    "mimoc.components.objects.furniture.build:build_table",
    start="mimoc.components.objects.furniture.build:start_table",
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


STAIRS = ObjectKind("stairs", "Stairs.", StairsSpec, "mimoc.components.objects.furniture.build:build_stairs")


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
    "mimoc.components.objects.furniture.build:build_slope",
    start="mimoc.components.objects.furniture.build:start_slope",
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
    "wall", "A wall, which can have a picture on it.", WallSpec, "mimoc.components.objects.furniture.build:build_wall"
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
    "screen", "A screen that shows a picture.", ScreenSpec, "mimoc.components.objects.furniture.build:build_screen"
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
    "mimoc.components.objects.furniture.build:build_water",
    start="mimoc.components.objects.furniture.build:start_water",
    poses=("supine", "prone", "sitting", "standing"),
    run="mimoc.components.objects.furniture.water",
)
