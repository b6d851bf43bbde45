"""A room drawn at random: floor, ceiling and four walls, pictures and lamps."""

import math
from dataclasses import dataclass

import numpy as np

from mimoc.geometry.rotations import Vec3
from mimoc.looks.wallpaper import OWN_WALLPAPERS, Wallpapers
from mimoc.mjcf.furniture import Furniture, Headlight
from mimoc.mjcf.materials import UNTINTED, WorldMaterial, WorldTexture
from mimoc.mjcf.world import World
from mimoc.random_streams import between, pick, stream
from mimoc.scenes.built_scene import HEADLIGHT, BuiltScene, Occupant, Placement
from mimoc.scenes.footprint import reach_of
from mimoc.scenes.room.lamps import SHADE, hang_lamps
from mimoc.scenes.room.pictures import hang_pictures
from mimoc.scenes.room.provenance import trace_room
from mimoc.scenes.room.sides import papered, plane, sides
from mimoc.scenes.spec import SceneSpec

Range = tuple[float, float]

CLEARANCE_M = 0.6
"""Between an infant and the walls, as in MIMo."""


@dataclass(frozen=True, slots=True)
class Room:
    """A room around the origin, its floor at z = 0."""

    size_m: Vec3
    """Depth, width and height: along x, y and z."""
    furniture: Furniture
    headlight: Headlight = HEADLIGHT


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a room drawn from the seed, the infant anywhere in it that is clear of the walls."""
    room = draw_room(spec.room.size_m, spec.seed, wallpapers)
    depth, width, _ = room.size_m
    start = place_infant(room.size_m, reach_of(occupant.discs), stream(spec.seed, "infant.place"))
    return BuiltScene(
        World(headlight=room.headlight, furniture=room.furniture),
        start,
        (depth / 2, width / 2),
        trace_room(room.size_m, room.furniture, start),
    )


def draw_room(size_m: tuple[Range, Range, Range], seed: int, wallpapers: Wallpapers = OWN_WALLPAPERS) -> Room:
    """Return a room; its size, floor, ceiling, walls, pictures and lamps each come from a stream of their own.

    Args:
        size_m: Ranges of depth, width and height.
        seed: Of everything drawn.
        wallpapers: What to draw from; with no pictures, none hang.
    """
    sizes = stream(seed, "room.size")
    depth, width, height = (between(sizes, low, high) for low, high in size_m)
    planes = sides(depth, width, height)
    walls = planes[2:]
    papers = [
        pick(stream(seed, "room.floor"), wallpapers.floors),
        pick(stream(seed, "room.ceiling"), wallpapers.ceilings),
        *(pick(stream(seed, f"room.{wall.name}"), wallpapers.walls) for wall in walls),
    ]
    hung = list(hang_pictures(stream(seed, "room.pictures"), walls, wallpapers.pictures))
    lamps, lights = hang_lamps(stream(seed, "room.light"), depth, width, height)
    used = {paper.name: paper for paper in [*papers, *(picture for _, picture in hung)]}
    return Room(
        (depth, width, height),
        Furniture(
            geoms=(*map(plane, planes), *(geom for geom, _ in hung), *lamps),
            materials=(
                *(papered(side, paper) for side, paper in zip(planes, papers, strict=True)),
                *(WorldMaterial(geom.material, UNTINTED, picture.name) for geom, picture in hung),
                SHADE,
            ),
            textures=tuple(WorldTexture(name, f"assets/{name}.png", used[name].png) for name in sorted(used)),
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
