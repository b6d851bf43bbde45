"""A furnished room drawn at random."""

from typing import Annotated

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.kinds import SceneKind
from mimoc.schema.quantities import Metres, Rising

RoomSide = Annotated[Metres, Field(ge=1, le=20)]
RoomSideRange = Annotated[tuple[RoomSide, RoomSide], Rising]


class RoomSpec(Model):
    """Options of `kind: room`, whose size and furnishing depend on the seed."""

    size_m: tuple[RoomSideRange, RoomSideRange, RoomSideRange] = ((2.5, 5.0), (2.5, 5.0), (2.2, 3.0))
    """Ranges of the room's depth, width and height."""


KIND = SceneKind(
    name="room",
    about="A furnished room drawn at random.",
    build="mimoc.components.scenes.room.build",
    spec=RoomSpec,
)
