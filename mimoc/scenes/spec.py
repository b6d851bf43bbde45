"""The world an infant is in."""

from typing import Annotated, Literal, Self

from pydantic import Field, StringConstraints, model_validator

from mimoc.schema.base import KeyedError, Model
from mimoc.schema.body import PartName
from mimoc.schema.quantities import Centimetres, Distinct, Metres, Rising, Whole

RoomSide = Annotated[Metres, Field(ge=1, le=20)]
RoomSideRange = Annotated[tuple[RoomSide, RoomSide], Rising]
ToyCount = Annotated[Whole, Field(ge=0, le=50)]
ToySize = Annotated[Centimetres, Field(ge=0.5, le=100)]
ToyName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=255)]


class RoomSpec(Model):
    """The room of `kind: room`, drawn anew from every seed."""

    size_m: tuple[RoomSideRange, RoomSideRange, RoomSideRange] = ((2.5, 5.0), (2.5, 5.0), (2.2, 3.0))
    """Ranges of depth, width and height."""


PathText = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=4096)]


class TexturesSpec(Model):
    """A user's own pictures, drawn from besides mimoc's; each a PNG or a folder of them, seen from the spec's."""

    floor: PathText | None = None
    """For the floor of a room."""
    ceiling: PathText | None = None
    """For its ceiling."""
    wall: PathText | None = None
    """For its walls."""


class ToysSpec(Model):
    """The toys around the infant."""

    source: Literal["builtin", "toys4k"] = "builtin"
    """Those that come with mimoc, or the Toys4K data set."""
    root: PathText | None = None
    """Folder that Toys4K was unpacked to; `~` and environment variables count, and it is seen from the spec's."""
    subset: Annotated[tuple[ToyName, ...], Distinct] = ()
    """Categories, such as `ball`, and single objects, such as `truck_003`, to choose from; empty means all. Of a folder
    of meshes of one's own, names of files without their ends."""
    count: Annotated[tuple[ToyCount, ToyCount], Rising] = (3, 6)
    """Range of how many."""
    size_cm: Annotated[tuple[ToySize, ToySize], Rising] = (4.0, 12.0)
    """Range of their longest side."""

    @model_validator(mode="after")
    def _has_a_root(self) -> Self:
        if self.source == "toys4k" and self.root is None:
            raise KeyedError(("root",), "is missing, and 'source: toys4k' needs it; add the folder you unpacked it to")
        return self


class SceneSpec(Model):
    """The world an infant is in."""

    kind: Literal["empty", "flat", "crib", "room"] = "flat"
    """Nothing, a floor, a crib, or a furnished room."""
    seed: Annotated[Whole, Field(ge=0, le=2**53)] = 0
    """Of everything drawn by chance."""
    pose: Literal["supine", "prone", "sitting", "standing"] = "supine"
    """How the infant starts; of the tasks, only `rollover` and `free` start from here.

    A bundle has the other poses too, but for those in which what is held or locked would be elsewhere.
    """
    held: Annotated[tuple[PartName, ...], Distinct] = ()
    """Parts of the infant that stay where they are in the world, such as `chest`, as if in a seat."""
    room: RoomSpec = Field(default_factory=RoomSpec)
    """The room, where the kind is room."""
    textures: TexturesSpec = Field(default_factory=TexturesSpec)
    """What else its floor, ceiling and walls may look like."""
    toys: ToysSpec | None = None
    """Toys; left out, there are none."""

    @model_validator(mode="after")
    def _toys_have_a_floor(self) -> Self:
        if self.toys and self.kind == "empty":
            raise KeyedError(("toys",), "toys need a floor, and an empty world has none; use another kind of scene")
        return self
