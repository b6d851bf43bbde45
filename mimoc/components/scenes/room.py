"""A room drawn at random: floor, ceiling and four walls, pictures and lamps."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.base.geometry.rotations import Vec3
from mimoc.base.random_streams import SEED, between, drawn_rule, pick, shuffled, stream, whole_between
from mimoc.body.origins import Entry
from mimoc.compiler.looks.wallpaper import OWN_WALLPAPERS, Wallpaper, Wallpapers
from mimoc.compiler.mjcf.elements import (
    UNTINTED,
    Furniture,
    SpotLight,
    WorldGeom,
    WorldMaterial,
    WorldTexture,
    untouched,
)
from mimoc.compiler.mjcf.world import World
from mimoc.compiler.scenes import HEADLIGHT, BuiltScene, Occupant, Placement, reach_of
from mimoc.schema.scene import SceneSpec

Range = tuple[float, float]

QUADS = 16  # Facets along a side: MuJoCo computes light at their corners only.
SIDES = ("floor", "ceiling", "wall_front", "wall_back", "wall_left", "wall_right")
PICTURE_COUNT = (2, 4)  # Never two on one wall.
EYE_HEIGHT_M = (1.2, 1.6)  # Lowest and greatest height of the middle of a picture.
MARGIN_M = 0.1  # Width of the free wall around a picture.
OFF_THE_WALL_M = 0.012  # Gap behind pictures, and above lamps, so that nothing shows through, even from 20 m away.

LAMP_COUNT = (1, 2)
LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M = 0.16, 0.025
LAMP_LIGHT = 0.34  # All lamps together, on what faces them: with the headlight, white walls are just not overexposed.
WARMEST, COOLEST = (1.0, 0.93, 0.82), (0.96, 0.98, 1.0)
SHADE = WorldMaterial("lamp", (1.0, 0.98, 0.93, 1.0), emission=0.9)

CLEARANCE_M = 0.6  # Between an infant and the walls, as in MIMo.


@dataclass(frozen=True, slots=True)
class Side:
    """One of the six planes; looking at it from inside, its x points right and its y up."""

    name: str
    extent_m: tuple[float, float]
    pos_m: Vec3
    euler_rad: Vec3
    inwards: Vec3  # Where its z points.


def sides(depth: float, width: float, height: float) -> tuple[Side, ...]:
    """Return floor, ceiling and walls: before, behind, left and right of one who looks along x."""
    upright = math.pi / 2
    middle = height / 2
    return (
        Side("floor", (depth, width), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        Side("ceiling", (depth, width), (0.0, 0.0, height), (math.pi, 0.0, 0.0), (0.0, 0.0, -1.0)),
        Side("wall_front", (width, height), (depth / 2, 0.0, middle), (upright, -upright, 0.0), (-1.0, 0.0, 0.0)),
        Side("wall_back", (width, height), (-depth / 2, 0.0, middle), (upright, upright, 0.0), (1.0, 0.0, 0.0)),
        Side("wall_left", (depth, height), (0.0, width / 2, middle), (upright, 0.0, 0.0), (0.0, -1.0, 0.0)),
        Side("wall_right", (depth, height), (0.0, -width / 2, middle), (upright, math.pi, 0.0), (0.0, 1.0, 0.0)),
    )


def plane(side: Side) -> WorldGeom:
    """Return the geom of a side; of these, only the floor touches by contact bits."""
    across, up = side.extent_m
    size_m = (across / 2, up / 2, max(across, up) / QUADS)
    is_barrier = side.name != "floor"
    geom = WorldGeom(side.name, "plane", size_m, side.pos_m, side.euler_rad, side.name, barrier=is_barrier)
    return untouched(geom) if is_barrier else geom


def papered(side: Side, paper: Wallpaper) -> WorldMaterial:
    """Return the material of a side: its texture at its real size."""
    across, up = (
        extent / tile if math.isfinite(tile) else 1.0 for extent, tile in zip(side.extent_m, paper.tile_m, strict=True)
    )
    return WorldMaterial(side.name, UNTINTED, paper.name, (across, up))


def hang_pictures(
    generator: np.random.Generator, walls: Sequence[Side], pictures: Sequence[Wallpaper]
) -> Iterator[tuple[WorldGeom, Wallpaper]]:
    """Yield pictures, each on a wall of its own, and where they hang."""
    count = whole_between(generator, *PICTURE_COUNT) if pictures else 0
    order = shuffled(generator, pictures)
    for number, wall in enumerate(shuffled(generator, walls)[:count]):
        picture = order[number % len(order)]
        sideways = between(generator, -1, 1)
        eye_height_m = between(generator, *EYE_HEIGHT_M)
        # A picture on a wall, smaller or lower than drawn where it would not fit.
        name = f"picture_{number + 1}"
        room = [extent - 2 * MARGIN_M for extent in wall.extent_m]
        scale = min(1.0, *(space / side for space, side in zip(room, picture.tile_m, strict=True)))
        half_width, half_height = (scale * side / 2 for side in picture.tile_m)
        along = sideways * (room[0] / 2 - half_width)
        z = min(eye_height_m, wall.extent_m[1] - MARGIN_M - half_height)
        x, y, _ = wall.pos_m
        in_x, in_y, _ = wall.inwards
        size_m = (half_width, half_height, max(half_width, half_height) / QUADS * 2)
        pos_m = (x + OFF_THE_WALL_M * in_x - along * in_y, y + OFF_THE_WALL_M * in_y + along * in_x, z)
        yield untouched(WorldGeom(name, "plane", size_m, pos_m, wall.euler_rad, name)), picture


def _trace_room(size_m: Vec3, furniture: Furniture, start: Placement) -> Iterator[tuple[str, Entry]]:
    rule = drawn_rule("as depth, width and height, each between the ends of its range", "room.size")
    yield "room.size", {"value": size_m, "unit": "m", "rule": rule, "from": [SEED, "spec.scene.room.size_m"]}
    rule = drawn_rule("anywhere that is clear of the walls", "infant.place")
    yield "room.infant.pos", {"value": (start.x_m, start.y_m), "unit": "m", "rule": rule, "from": [SEED, "room.size"]}
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
    sources = ["room.size"]
    at = f"scene.xml: geom[@name='{geom.name}']"
    size = {"value": geom.size_m[:2], "unit": "m", "rule": "half of the room's sides", "from": sources}
    yield f"room.{geom.name}.size", {**size, "xml": f"{at}/@size"}
    place = {"value": geom.pos_m, "unit": "m", "rule": "the room is around the origin", "from": sources}
    yield f"room.{geom.name}.pos", {**place, "xml": f"{at}/@pos"}
    rule = drawn_rule("from mimoc's and one's own", f"room.{geom.name}")
    yield f"room.{geom.name}.paper", {"value": papers[geom.material], "rule": rule, "from": [SEED]}


def _trace_hung(geom: WorldGeom, papers: dict[str, str]) -> Iterator[tuple[str, Entry]]:
    is_picture = geom.material in papers
    aspect = "room.pictures" if is_picture else "room.light"
    at = f"scene.xml: geom[@name='{geom.name}']"
    rule = drawn_rule("on a wall of its own, at eye height" if is_picture else "in a row on the ceiling", aspect)
    place = {"value": geom.pos_m, "unit": "m", "rule": rule, "from": [SEED, "room.size"], "xml": f"{at}/@pos"}
    yield f"room.{geom.name}.pos", place
    rule = "half of the picture's sides, smaller where the wall is" if is_picture else "that of every lamp"
    yield f"room.{geom.name}.size", {"value": geom.size_m[:2], "unit": "m", "rule": rule, "xml": f"{at}/@size"}
    if is_picture:
        rule = drawn_rule("from mimoc's", aspect)
        yield f"room.{geom.name}.picture", {"value": papers[geom.material], "rule": rule, "from": [SEED]}


def hang_lamps(
    generator: np.random.Generator, depth: float, width: float, height: float
) -> tuple[tuple[WorldGeom, ...], tuple[SpotLight, ...]]:
    """Return lamps on the ceiling, in a row along the longer side, and their light."""
    count = whole_between(generator, *LAMP_COUNT)
    warmth = generator.random()
    brightness = between(generator, 0.85, 1.0)
    sideways, along = (between(generator, -0.1, 0.1) for _ in range(2))
    red, green, blue = (
        brightness * LAMP_LIGHT / count * (warmth * warm + (1 - warmth) * cool)
        for warm, cool in zip(WARMEST, COOLEST, strict=True)
    )
    shares = [((number + 0.5) / count - 0.5 + along, sideways) for number in range(count)]
    if depth < width:
        shares = [(across, down) for down, across in shares]
    places = [(depth * share_x, width * share_y) for share_x, share_y in shares]
    lamps = tuple(_lamp(number, (x, y, height)) for number, (x, y) in enumerate(places, start=1))
    lights = tuple(_light(number, (x, y, height), (red, green, blue)) for number, (x, y) in enumerate(places, start=1))
    return lamps, lights


def _lamp(number: int, ceiling_m: Vec3) -> WorldGeom:
    x, y, height = ceiling_m
    size_m = (LAMP_RADIUS_M, LAMP_HALF_HEIGHT_M)
    z = height - OFF_THE_WALL_M - LAMP_HALF_HEIGHT_M
    return untouched(WorldGeom(f"lamp_{number}", "cylinder", size_m, (x, y, z), (0.0, 0.0, 0.0), SHADE.name))


def _light(number: int, ceiling_m: Vec3, diffuse: Vec3) -> SpotLight:
    """Return the light of a lamp; only that of the first casts shadows."""
    x, y, height = ceiling_m
    return SpotLight(
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


@dataclass(frozen=True, slots=True)
class Room:
    """A room around the origin, its floor at z = 0."""

    size_m: Vec3  # Depth, width and height: along x, y and z.
    furniture: Furniture


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a room drawn from the seed, the infant anywhere in it that is clear of the walls."""
    room = draw_room(spec.room.size_m, spec.seed, wallpapers)
    depth, width, _ = room.size_m
    start = place_infant(room.size_m, reach_of(occupant.discs), stream(spec.seed, "infant.place"))
    return BuiltScene(
        World(headlight=HEADLIGHT, furniture=room.furniture),
        start,
        (depth / 2, width / 2),
        dict(_trace_room(room.size_m, room.furniture, start)),
    )


def draw_room(size_m: tuple[Range, Range, Range], seed: int, wallpapers: Wallpapers = OWN_WALLPAPERS) -> Room:
    """Return a room; its size, floor, ceiling, walls, pictures and lamps each come from a stream of their own."""
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
    """Return a place for an infant that reaches *radius_m* far, clear of the walls; in a narrow room, the middle."""
    free_m = [max(side / 2 - radius_m - CLEARANCE_M, 0.0) for side in size_m[:2]]
    x_m, y_m = (between(generator, -free, free) for free in free_m)
    return Placement(x_m, y_m, between(generator, 0.0, 2 * math.pi))
