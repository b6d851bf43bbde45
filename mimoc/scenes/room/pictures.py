"""Pictures on the walls of a room."""

from collections.abc import Iterator, Sequence

import numpy as np

from mimoc.looks.wallpaper import Wallpaper
from mimoc.mjcf.furniture import UNTOUCHED, WorldGeom
from mimoc.random_streams import between, shuffled, whole_between
from mimoc.scenes.room.sides import QUADS, Side

PICTURE_COUNT = (2, 4)
"""Never two on one wall."""
EYE_HEIGHT_M = (1.2, 1.6)
"""Of the middle of a picture."""
MARGIN_M = 0.1
"""Of free wall around a picture."""
OFF_THE_WALL_M = 0.012
"""Gap behind pictures, and above lamps, so that nothing shows through, even from 20 m away."""


def hang_pictures(
    generator: np.random.Generator, walls: Sequence[Side], pictures: Sequence[Wallpaper]
) -> Iterator[tuple[WorldGeom, Wallpaper]]:
    """Yield pictures, each on a wall of its own, and where they hang."""
    count = whole_between(generator, *PICTURE_COUNT) if pictures else 0
    order = shuffled(generator, pictures)
    for number, wall in enumerate(shuffled(generator, walls)[:count]):
        picture = order[number % len(order)]
        sideways, eye_height_m = between(generator, -1, 1), between(generator, *EYE_HEIGHT_M)
        yield _hung(f"picture_{number + 1}", wall, picture, sideways, eye_height_m), picture


def _hung(name: str, wall: Side, picture: Wallpaper, sideways: float, eye_height_m: float) -> WorldGeom:
    """Return a picture on a wall, smaller or lower than drawn where it would not fit.

    Args:
        name: Of the geom.
        wall: The wall it hangs on.
        picture: Its texture and size.
        sideways: Where along the wall: -1 for as far left as it can be, 1 for right.
        eye_height_m: Of its middle.
    """
    room = [extent - 2 * MARGIN_M for extent in wall.extent_m]
    scale = min(1.0, *(space / side for space, side in zip(room, picture.tile_m, strict=True)))
    half_width, half_height = (scale * side / 2 for side in picture.tile_m)
    along = sideways * (room[0] / 2 - half_width)
    z = min(eye_height_m, wall.extent_m[1] - MARGIN_M - half_height)
    x, y, _ = wall.pos_m
    in_x, in_y, _ = wall.inwards
    return WorldGeom(
        name,
        "plane",
        (half_width, half_height, max(half_width, half_height) / QUADS * 2),
        (x + OFF_THE_WALL_M * in_x - along * in_y, y + OFF_THE_WALL_M * in_y + along * in_x, z),
        wall.euler_rad,
        name,
        contype=UNTOUCHED,
        conaffinity=UNTOUCHED,
    )
