"""Wallpapers: textures for floors, ceilings and walls, and pictures that hang on them."""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from mimoc.looks.drawing import FloatArray, encode_palette_png
from mimoc.looks.patterns import ceilings, floors, pictures, walls

WHOLE = math.inf
"""Width or height of a tile that spans the whole surface."""


@dataclass(frozen=True, slots=True)
class Wallpaper:
    """A texture and its size in the scene."""

    name: str
    """Name of the material and of the file: [a-z0-9_]+."""
    tile_m: tuple[float, float]
    """Width and height of one repeat, or of a picture with its frame."""
    draw: Callable[[], bytes]
    """Function that returns the PNG, whose top is up on a wall; always the same bytes."""


def _table(kind: str, *rows: tuple[tuple[float, float], Callable[[], FloatArray]]) -> Mapping[str, Wallpaper]:
    """Return wallpapers by the names of the functions that draw them."""
    return MappingProxyType(
        {
            paint.__name__: Wallpaper(
                f"{kind}_{paint.__name__}", tile_m, functools.cache(functools.partial(_png, paint))
            )
            for tile_m, paint in rows
        }
    )


def _png(paint: Callable[[], FloatArray]) -> bytes:
    return encode_palette_png(paint())


FLOORS = _table(
    "floor",
    ((0.84, 1.4), floors.oak_boards),
    ((0.84, 1.4), floors.dark_boards),
    ((1.0, 1.0), floors.parquet),
    ((0.6, 0.6), floors.chequered_tiles),
    ((0.9, 0.9), floors.terracotta),
    ((0.8, 0.8), floors.carpet),
    ((0.7, 0.7), floors.play_mat),
    ((0.5, 0.5), floors.cork),
)
CEILINGS = _table(
    "ceiling",
    ((1.2, 1.2), ceilings.plaster),
    ((0.9, 1.2), ceilings.boards),
    ((1.2, 1.2), ceilings.panels),
    ((2.0, 2.0), ceilings.clouds),
    ((1.0, 1.0), ceilings.golden_stars),
)
WALLS = _table(
    "wall",
    ((1.0, 1.0), walls.plaster),
    ((0.6, 0.6), walls.stripes),
    ((0.6, 0.6), walls.dots),
    ((0.7, 0.7), walls.stars),
    ((0.7, 0.6), walls.triangles),
    ((0.7, 0.7), walls.flowers),
    ((0.7, 0.7), walls.leaves),
    ((0.96, 0.6), walls.bricks),
    ((0.9, WHOLE), walls.wainscot),
    ((0.6, 0.6), walls.gingham),
)
PICTURES = _table(
    "picture",
    ((0.60, 0.45), pictures.mountains),
    ((0.60, 0.45), pictures.house),
    ((0.48, 0.36), pictures.boat),
    ((0.64, 0.48), pictures.sunny_hills),
    ((0.48, 0.36), pictures.duck),
    ((0.48, 0.36), pictures.cat),
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
