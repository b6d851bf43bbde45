"""Scenes: those that need no file of their own, and what a user can ask of a room."""

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.kinds import SceneKind
from mimoc.schema.quantities import Metres, Rising

if TYPE_CHECKING:
    from mimoc.compiler.looks.wallpaper import Wallpapers
    from mimoc.compiler.scenes import BuiltScene, Occupant
    from mimoc.schema.scene import SceneSpec

RoomSide = Annotated[Metres, Field(ge=1, le=20)]
RoomSideRange = Annotated[tuple[RoomSide, RoomSide], Rising]


class RoomSpec(Model):
    """Options of `kind: room`, whose size and furnishing depend on the seed."""

    size_m: tuple[RoomSideRange, RoomSideRange, RoomSideRange] = ((2.5, 5.0), (2.5, 5.0), (2.2, 3.0))
    """Ranges of the room's depth, width and height."""


ROOM = SceneKind("room", "A furnished room drawn at random.", "mimoc.components.scenes.room", RoomSpec)


def build_empty(spec: "SceneSpec", occupant: "Occupant", wallpapers: "Wallpapers") -> "BuiltScene":
    """Return a world without floor and gravity, in which the infant floats."""
    from mimoc.compiler.mjcf.world import World
    from mimoc.compiler.scenes import SUN, WEIGHTLESS, BuiltScene

    return BuiltScene(World(gravity_m_s2=WEIGHTLESS, lights=(SUN,)))


def build_flat(spec: "SceneSpec", occupant: "Occupant", wallpapers: "Wallpapers") -> "BuiltScene":
    """Return a floor at z = 0."""
    from mimoc.compiler.mjcf.world import Ground, World
    from mimoc.compiler.scenes import SUN, BuiltScene

    return BuiltScene(World(grounds=(Ground("floor", 0.0),), lights=(SUN,)))
