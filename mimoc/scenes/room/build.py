"""A room drawn at random: floor, ceiling and four walls, pictures and lamps."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mimoc.body.origins import Entry
from mimoc.geometry.rotations import Vec3
from mimoc.looks.wallpaper import OWN_WALLPAPERS, Wallpapers
from mimoc.mjcf.furniture import UNTOUCHED, Furniture, Headlight, SpotLight, WorldGeom
from mimoc.mjcf.materials import UNTINTED, WorldMaterial, WorldTexture
from mimoc.mjcf.world import World
from mimoc.random_streams import SEED, between, drawn_rule, pick, stream, whole_between
from mimoc.scenes.built_scene import HEADLIGHT, BuiltScene, Occupant, Placement
from mimoc.scenes.footprint import reach_of
from mimoc.scenes.room.pictures import OFF_THE_WALL_M, hang_pictures
from mimoc.scenes.room.sides import SIDES, papered, plane, sides
from mimoc.scenes.spec import SceneSpec


def trace_room(size_m: Vec3, furniture: Furniture, start: Placement) -> dict[str, Entry]:
    """Return where the numbers of a room come from, by key in `provenance.json`.

    Args:
        size_m: Depth, width and height.
        furniture: What stands and hangs in it.
        start: Where the infant is in it.
    """
    return dict(_trace_room(size_m, furniture, start))


def _trace_room(size_m: Vec3, furniture: Furniture, start: Placement) -> Iterator[tuple[str, Entry]]:
    rule = drawn_rule("as depth, width and height, each between the ends of its range", "room.size")
    yield "room.size", {"value": size_m, "unit": "m", "rule": rule, "from": [SEED, "spec.scene.room.size_m"]}
    rule = drawn_rule("anywhere that is clear of the walls", "infant.place")
    place = {"value": (start.x_m, start.y_m), "unit": "m", "rule": rule, "from": [SEED, "room.size"]}
    yield "room.infant.pos", place
    rule = drawn_rule("from all directions", "infant.place")
    yield "room.infant.yaw", {"value": start.yaw_rad, "unit": "rad", "rule": rule, "from": [SEED]}
    papers = {material.name: material.texture for material in furniture.materials if material.texture}
    for geom in furniture.geoms:
        yield from _trace_side(geom, papers) if geom.name in SIDES else _trace_hung(geom, papers)
    for light in furniture.lights:
        rule = drawn_rule("as warmth and brightness, of which all lamps have a share", "room.light")
        xml = f"scene.xml: light[@name='{light.name}']/@diffuse"
        yield f"room.{light.name}.diffuse", {"value": light.diffuse, "rule": rule, "from": [SEED], "xml": xml}


def _trace_side(geom: WorldGeom, papers: dict[str, str]) -> Iterator[tuple[str, Entry]]:
    sources, at = ["room.size"], f"scene.xml: geom[@name='{geom.name}']"
    size = {"value": geom.size_m[:2], "unit": "m", "rule": "half of the room's sides", "from": sources}
    yield f"room.{geom.name}.size", {**size, "xml": f"{at}/@size"}
    place = {"value": geom.pos_m, "unit": "m", "rule": "the room is around the origin", "from": sources}
    yield f"room.{geom.name}.pos", {**place, "xml": f"{at}/@pos"}
    rule = drawn_rule("from mimoc's and one's own", f"room.{geom.name}")
    yield f"room.{geom.name}.paper", {"value": papers[geom.material], "rule": rule, "from": [SEED]}


def _trace_hung(geom: WorldGeom, papers: dict[str, str]) -> Iterator[tuple[str, Entry]]:
    """Yield the numbers of a picture or a lamp."""
    is_picture = geom.material in papers
    aspect, at = "room.pictures" if is_picture else "room.light", f"scene.xml: geom[@name='{geom.name}']"
    rule = drawn_rule("on a wall of its own, at eye height" if is_picture else "in a row on the ceiling", aspect)
    sources = [SEED, "room.size"]
    yield (
        f"room.{geom.name}.pos",
        {"value": geom.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"},
    )
    rule = "half of the picture's sides, smaller where the wall is" if is_picture else "that of every lamp"
    yield f"room.{geom.name}.size", {"value": geom.size_m[:2], "unit": "m", "rule": rule, "xml": f"{at}/@size"}
    if is_picture:
        rule = drawn_rule("from mimoc's", aspect)
        yield f"room.{geom.name}.picture", {"value": papers[geom.material], "rule": rule, "from": [SEED]}


LAMP_COUNT = (1, 2)
LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M = 0.16, 0.025
LAMP_LIGHT = 0.34
"""All lamps together, on what faces them: with the headlight, white walls are just not overexposed."""
WARMEST, COOLEST = (1.0, 0.93, 0.82), (0.96, 0.98, 1.0)
SHADE = WorldMaterial("lamp", (1.0, 0.98, 0.93, 1.0), emission=0.9)


def hang_lamps(
    generator: np.random.Generator, depth: float, width: float, height: float
) -> tuple[tuple[WorldGeom, ...], tuple[SpotLight, ...]]:
    """Return lamps on the ceiling, in a row along the longer side, and their light."""
    count = whole_between(generator, *LAMP_COUNT)
    warmth, brightness = generator.random(), between(generator, 0.85, 1.0)
    sideways, along = (between(generator, -0.1, 0.1) for _ in range(2))
    red, green, blue = (
        brightness * LAMP_LIGHT / count * (warmth * warm + (1 - warmth) * cool)
        for warm, cool in zip(WARMEST, COOLEST, strict=True)
    )
    shares = [((number + 0.5) / count - 0.5 + along, sideways) for number in range(count)]
    if depth < width:
        shares = [(across, down) for down, across in shares]
    places = [(depth * share_x, width * share_y) for share_x, share_y in shares]
    lamps = list(_lamps(places, height))
    lights = list(_lights(places, height, (red, green, blue)))
    return tuple(lamps), tuple(lights)


def _lamps(places: list[tuple[float, float]], height: float) -> Iterator[WorldGeom]:
    for number, (x, y) in enumerate(places, start=1):
        yield WorldGeom(
            f"lamp_{number}",
            "cylinder",
            (LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M),
            (x, y, height - OFF_THE_WALL_M - LAMP_HALF_HEIGHT_M),
            (0.0, 0.0, 0.0),
            SHADE.name,
            contype=UNTOUCHED,
            conaffinity=UNTOUCHED,
        )


def _lights(places: list[tuple[float, float]], height: float, diffuse: Vec3) -> Iterator[SpotLight]:
    """Yield the light of each lamp; only that of the first casts shadows."""
    for number, (x, y) in enumerate(places, start=1):
        yield SpotLight(
            f"lamp_{number}",
            (x, y, height - 3 * LAMP_HALF_HEIGHT_M),
            (0.0, 0.0, -1.0),
            diffuse,
            specular=(0.05, 0.05, 0.05),
            attenuation=(1.0, 0.0, 0.0),
            cutoff_deg=90.0,
            exponent=0.0,
            castshadow=number == 1,
        )


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
