"""A furnished room drawn at random."""

from mimoc.base.kinds import SceneKind
from mimoc.scenes.room.spec import RoomSpec

KIND = SceneKind(
    name="room",
    about="A furnished room drawn at random.",
    build="mimoc.scenes.room.build",
    spec=RoomSpec,
)
