"""A room drawn by chance: floor, ceiling and four walls, pictures and lamps."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.geometry.rotations import Vec3
from mimoc.looks.appearance import UNTINTED
from mimoc.looks.wallpaper import Wallpaper
from mimoc.mjcf.furniture import (
    SOLID,
    UNTOUCHED,
    Furniture,
    Headlight,
    WorldGeom,
    WorldLight,
    WorldMaterial,
    WorldTexture,
)
from mimoc.mjcf.tree import World
from mimoc.random_streams import between, pick, shuffled, stream, whole_between
from mimoc.scenes.footprint import reach_of
from mimoc.scenes.setting import HEADLIGHT, OWN_DECOR, Decor, Occupant, Placement, Setting
from mimoc.scenes.spec import SceneSpec

Range = tuple[float, float]

CLEARANCE_M = 0.6
"""Between an infant and the walls, as in MIMo."""
PICTURE_COUNT = (2, 4)
"""Never two on one wall."""
EYE_HEIGHT_M = (1.2, 1.6)
"""Of the middle of a picture."""
MARGIN_M = 0.1
"""Of wall that a picture leaves free all around."""
OFF_THE_WALL_M = 0.012
"""How far from it pictures hang, and lamps from the ceiling, so that nothing shines through, even 20 m away."""
LAMP_COUNT = (1, 2)
LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M = 0.16, 0.025
LAMP_LIGHT = 0.34
"""All lamps together, on what faces them: with the headlight, white walls are just not burnt out."""
WARMEST, COOLEST = (1.0, 0.93, 0.82), (0.96, 0.98, 1.0)
QUADS = 16
"""Facets along a side: MuJoCo works out light at their corners only."""


@dataclass(frozen=True, slots=True)
class Room:
    """A room around the origin, its floor at z = 0."""

    size_m: Vec3
    """Depth, width and height: along x, y and z."""
    furniture: Furniture
    headlight: Headlight = HEADLIGHT


@dataclass(frozen=True, slots=True)
class _Side:
    """One of the six planes; looking at it from inside, its x points right and its y up."""

    name: str
    extent_m: tuple[float, float]
    pos_m: Vec3
    euler_rad: Vec3
    inwards: Vec3
    """Where its z points."""


def build(spec: SceneSpec, occupant: Occupant, decor: Decor) -> Setting:
    """Return a room drawn from the seed, the infant anywhere in it that is clear of the walls."""
    room = draw_room(spec.room.size_m, spec.seed, decor)
    depth, width, _ = room.size_m
    return Setting(
        World(headlight=room.headlight, furniture=room.furniture),
        place_infant(room.size_m, reach_of(occupant.discs), stream(spec.seed, "infant.place")),
        (depth / 2, width / 2),
    )


def draw_room(size_m: tuple[Range, Range, Range], seed: int, decor: Decor = OWN_DECOR) -> Room:
    """Return a room; its size, floor, ceiling, walls, pictures and lamps are drawn apart from each other.

    Args:
        size_m: Ranges of depth, width and height.
        seed: Of everything drawn.
        decor: What to draw from; with no pictures, none hang.
    """
    sizes = stream(seed, "room.size")
    depth, width, height = (between(sizes, low, high) for low, high in size_m)
    sides = _sides(depth, width, height)
    walls = sides[2:]
    papers = [
        pick(stream(seed, "room.floor"), decor.floors),
        pick(stream(seed, "room.ceiling"), decor.ceilings),
        *(pick(stream(seed, f"room.{wall.name}"), decor.walls) for wall in walls),
    ]
    hung = list(_pictures(stream(seed, "room.pictures"), walls, decor.pictures))
    lamps, lights = _lamps(stream(seed, "room.light"), depth, width, height)
    worn = {paper.name: paper for paper in [*papers, *(picture for _, picture in hung)]}
    return Room(
        (depth, width, height),
        Furniture(
            geoms=(*map(_plane, sides), *(geom for geom, _ in hung), *lamps),
            materials=(
                *(_papered(side, paper) for side, paper in zip(sides, papers, strict=True)),
                *(WorldMaterial(geom.material, UNTINTED, picture.name) for geom, picture in hung),
                WorldMaterial("lamp", (1.0, 0.98, 0.93, 1.0), emission=0.9),
            ),
            textures=tuple(WorldTexture(name, f"assets/{name}.png", worn[name].draw()) for name in sorted(worn)),
            lights=lights,
        ),
    )


def place_infant(size_m: Vec3, radius_m: float, generator: np.random.Generator) -> Placement:
    """Return a place on the floor, anywhere clear of the walls; where a room is too narrow for that, in the middle.

    Args:
        size_m: Of the room.
        radius_m: How far from the vertical through its origin the infant reaches.
        generator: What to draw from.
    """
    free_m = [max(side / 2 - radius_m - CLEARANCE_M, 0.0) for side in size_m[:2]]
    x_m, y_m = (between(generator, -free, free) for free in free_m)
    return Placement(x_m, y_m, between(generator, 0.0, 2 * math.pi))


def _sides(depth: float, width: float, height: float) -> tuple[_Side, ...]:
    """Return floor, ceiling and walls: before, behind, left and right of one who looks along x."""
    upright = math.pi / 2
    middle = height / 2
    return (
        _Side("floor", (depth, width), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        _Side("ceiling", (depth, width), (0.0, 0.0, height), (math.pi, 0.0, 0.0), (0.0, 0.0, -1.0)),
        _Side("wall_front", (width, height), (depth / 2, 0.0, middle), (upright, -upright, 0.0), (-1.0, 0.0, 0.0)),
        _Side("wall_back", (width, height), (-depth / 2, 0.0, middle), (upright, upright, 0.0), (1.0, 0.0, 0.0)),
        _Side("wall_left", (depth, height), (0.0, width / 2, middle), (upright, 0.0, 0.0), (0.0, -1.0, 0.0)),
        _Side("wall_right", (depth, height), (0.0, -width / 2, middle), (upright, math.pi, 0.0), (0.0, 1.0, 0.0)),
    )


def _plane(side: _Side) -> WorldGeom:
    across, up = side.extent_m
    barrier = side.name != "floor"
    return WorldGeom(
        side.name,
        "plane",
        (across / 2, up / 2, max(across, up) / QUADS),
        side.pos_m,
        side.euler_rad,
        side.name,
        contype=UNTOUCHED if barrier else SOLID,
        conaffinity=UNTOUCHED if barrier else SOLID,
        barrier=barrier,
    )


def _papered(side: _Side, paper: Wallpaper) -> WorldMaterial:
    """Return the material of a side: its texture at its real size."""
    across, up = (
        extent / tile if math.isfinite(tile) else 1.0 for extent, tile in zip(side.extent_m, paper.tile_m, strict=True)
    )
    return WorldMaterial(side.name, UNTINTED, paper.name, (across, up))


def _pictures(
    generator: np.random.Generator, walls: Sequence[_Side], pictures: Sequence[Wallpaper]
) -> Iterator[tuple[WorldGeom, Wallpaper]]:
    """Yield pictures, each on a wall of its own, and where they hang."""
    count = whole_between(generator, *PICTURE_COUNT) if pictures else 0
    order = shuffled(generator, pictures)
    for number, wall in enumerate(shuffled(generator, walls)[:count]):
        picture = order[number % len(order)]
        sideways, eye_height_m = between(generator, -1, 1), between(generator, *EYE_HEIGHT_M)
        yield _hung(f"picture_{number + 1}", wall, picture, sideways, eye_height_m), picture


def _hung(name: str, wall: _Side, picture: Wallpaper, sideways: float, eye_height_m: float) -> WorldGeom:
    """Return a picture on a wall, smaller or lower than wished where it would not fit.

    Args:
        name: Of the geom.
        wall: What it hangs on.
        picture: What it shows.
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


def _lamps(
    generator: np.random.Generator, depth: float, width: float, height: float
) -> tuple[tuple[WorldGeom, ...], tuple[WorldLight, ...]]:
    """Return lamps on the ceiling, in a row along the longer side, and their light."""
    count = whole_between(generator, *LAMP_COUNT)
    warmth, dim = generator.random(), between(generator, 0.85, 1.0)
    sideways, along = (between(generator, -0.1, 0.1) for _ in range(2))
    red, green, blue = (
        dim * LAMP_LIGHT / count * (warmth * warm + (1 - warmth) * cool)
        for warm, cool in zip(WARMEST, COOLEST, strict=True)
    )
    places = [((number + 0.5) / count - 0.5 + along, sideways) for number in range(count)]
    shares = places if depth >= width else [(across, down) for down, across in places]
    geoms, lights = [], []
    for number, (share_x, share_y) in enumerate(shares, start=1):
        x, y = depth * share_x, width * share_y
        geoms.append(
            WorldGeom(
                f"lamp_{number}",
                "cylinder",
                (LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M),
                (x, y, height - OFF_THE_WALL_M - LAMP_HALF_HEIGHT_M),
                (0.0, 0.0, 0.0),
                "lamp",
                contype=UNTOUCHED,
                conaffinity=UNTOUCHED,
            )
        )
        lights.append(
            WorldLight(
                f"lamp_{number}",
                (x, y, height - 3 * LAMP_HALF_HEIGHT_M),
                (0.0, 0.0, -1.0),
                (red, green, blue),
                specular=(0.05, 0.05, 0.05),
                attenuation=(1.0, 0.0, 0.0),
                cutoff_deg=90.0,
                exponent=0.0,
                castshadow=number == 1,
            )
        )
    return tuple(geoms), tuple(lights)
