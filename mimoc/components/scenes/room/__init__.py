"""A furnished room drawn at random."""

from mimoc.components.scenes.room.spec import RoomSpec
from mimoc.schema.kinds import SceneKind

KIND = SceneKind(
    name="room",
    about="A furnished room drawn at random.",
    build="mimoc.components.scenes.room.build",
    spec=RoomSpec,
)
