"""Wallpapers: textures for floors, ceilings and walls, and pictures that hang on them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from mimoc.compiler.looks.pictures import read_picture

WHOLE = math.inf
"""Width or height of a tile that spans the whole surface."""


@dataclass(frozen=True, slots=True)
class Wallpaper:
    """A texture and its size in the scene."""

    name: str
    """Name of the material and of the file: [a-z0-9_]+."""
    tile_m: tuple[float, float]
    """Width and height of one repeat, or of a picture with its frame."""
    content: bytes | None = None
    """A user's PNG; None for those that ship with mimoc."""

    @property
    def png(self) -> bytes:
        """The PNG, whose top is up on a wall."""
        return read_picture(self.name) if self.content is None else self.content


def _table(kind: str, **tiles_m: tuple[float, float]) -> Mapping[str, Wallpaper]:
    """Return wallpapers by name; the name of the file begins with their kind."""
    return MappingProxyType({name: Wallpaper(f"{kind}_{name}", tile_m) for name, tile_m in tiles_m.items()})


FLOORS = _table(
    "floor",
    oak_boards=(0.84, 1.4),
    dark_boards=(0.84, 1.4),
    parquet=(1.0, 1.0),
    chequered_tiles=(0.6, 0.6),
    terracotta=(0.9, 0.9),
    carpet=(0.8, 0.8),
    play_mat=(0.7, 0.7),
    cork=(0.5, 0.5),
)
CEILINGS = _table(
    "ceiling",
    plaster=(1.2, 1.2),
    boards=(0.9, 1.2),
    panels=(1.2, 1.2),
    clouds=(2.0, 2.0),
    golden_stars=(1.0, 1.0),
)
WALLS = _table(
    "wall",
    plaster=(1.0, 1.0),
    stripes=(0.6, 0.6),
    dots=(0.6, 0.6),
    stars=(0.7, 0.7),
    triangles=(0.7, 0.6),
    flowers=(0.7, 0.7),
    leaves=(0.7, 0.7),
    bricks=(0.96, 0.6),
    wainscot=(0.9, WHOLE),
    gingham=(0.6, 0.6),
)
PICTURES = _table(
    "picture",
    mountains=(0.60, 0.45),
    house=(0.60, 0.45),
    boat=(0.48, 0.36),
    sunny_hills=(0.64, 0.48),
    duck=(0.48, 0.36),
    cat=(0.48, 0.36),
)


@dataclass(frozen=True, slots=True)
class Wallpapers:
    """The wallpapers to choose from for floors, ceilings and walls."""

    floors: Sequence[Wallpaper] = tuple(FLOORS.values())
    ceilings: Sequence[Wallpaper] = tuple(CEILINGS.values())
    walls: Sequence[Wallpaper] = tuple(WALLS.values())
    pictures: Sequence[Wallpaper] = tuple(PICTURES.values())


OWN_WALLPAPERS = Wallpapers()
"""The wallpapers that come with mimoc."""
