"""Where each number of the world around an infant comes from: its room, its toys, and what its task needs."""

import math
from collections.abc import Iterator

from mimoc.body.provenance import Entry
from mimoc.mjcf.furniture import WorldGeom
from mimoc.mjcf.rails import RAIL_IN_CHILDREN
from mimoc.mjcf.tree import Prop, SceneTree, World
from mimoc.scenes.crib.build import LENGTH_IN_CHILDREN
from mimoc.schema.infant import InfantSpec

SEED = "spec.scene.seed"
SIDES = ("floor", "ceiling", "wall_front", "wall_back", "wall_left", "wall_right")
"""The planes of a room."""


def trace_world(spec: InfantSpec, scene: SceneTree) -> dict[str, Entry]:
    """Return an entry for each number of a world; those drawn by chance name the stream of the seed they are from."""
    world = scene.world
    entries = dict(_trace_gravity(world))
    if spec.scene.kind == "room":
        entries.update(_trace_room(world))
    if spec.scene.kind == "crib":
        entries.update(_trace_crib(world))
    if spec.scene.toys:
        entries["toys.count"] = {
            "value": len(world.toys),
            "rule": _drawn("between the ends of the range", "toys.count"),
            "from": [SEED, "spec.scene.toys.count"],
        }
    for toy in world.toys:
        entries.update(_trace_toy(toy))
    for prop in world.apparatus:
        entries.update(_trace_apparatus(prop))
    return entries


def _drawn(what: str, aspect: str) -> str:
    """Return the rule of what chance decides; `mimoc.random_streams` makes the stream."""
    return f"drawn {what}, by the stream '{aspect}' of the seed"


def _trace_gravity(world: World) -> Iterator[tuple[str, Entry]]:
    rule = "the earth's; 0 in an empty world, and where a task takes it away"
    xml = "scene.xml: option/@gravity"
    yield (
        "scene.gravity",
        {"value": world.gravity_m_s2, "unit": "m/s2", "rule": rule, "from": ["spec.scene.kind"], "xml": xml},
    )


def _trace_room(world: World) -> Iterator[tuple[str, Entry]]:
    geoms = {geom.name: geom for geom in world.furniture.geoms}
    half_depth, half_width, _ = geoms["floor"].size_m
    size_m = (2 * half_depth, 2 * half_width, geoms["ceiling"].pos_m[2])
    rule = _drawn("as depth, width and height, each between the ends of its range", "room.size")
    yield "room.size", {"value": size_m, "unit": "m", "rule": rule, "from": [SEED, "spec.scene.room.size_m"]}
    x_m, y_m, yaw_rad = world.infant_at
    rule = _drawn("anywhere that is clear of the walls", "infant.place")
    yield "room.infant.pos", {"value": (x_m, y_m), "unit": "m", "rule": rule, "from": [SEED, "room.size"]}
    rule = _drawn("from all directions", "infant.place")
    yield "room.infant.yaw", {"value": yaw_rad, "unit": "rad", "rule": rule, "from": [SEED]}
    papers = {material.name: material.texture for material in world.furniture.materials if material.texture}
    for geom in world.furniture.geoms:
        yield from _trace_side(geom, papers) if geom.name in SIDES else _trace_hung(geom, papers)
    for light in world.furniture.lights:
        rule = _drawn("as warmth and brightness, of which all lamps have a share", "room.light")
        xml = f"scene.xml: light[@name='{light.name}']/@diffuse"
        yield f"room.{light.name}.diffuse", {"value": light.diffuse, "rule": rule, "from": [SEED], "xml": xml}


def _trace_side(geom: WorldGeom, papers: dict[str, str]) -> Iterator[tuple[str, Entry]]:
    sources, at = ["room.size"], f"scene.xml: geom[@name='{geom.name}']"
    size = {"value": geom.size_m[:2], "unit": "m", "rule": "half of the room's sides", "from": sources}
    yield f"room.{geom.name}.size", {**size, "xml": f"{at}/@size"}
    place = {"value": geom.pos_m, "unit": "m", "rule": "the room is around the origin", "from": sources}
    yield f"room.{geom.name}.pos", {**place, "xml": f"{at}/@pos"}
    rule = _drawn("from mimoc's and one's own", f"room.{geom.name}")
    yield f"room.{geom.name}.paper", {"value": papers[geom.material], "rule": rule, "from": [SEED]}


def _trace_hung(geom: WorldGeom, papers: dict[str, str]) -> Iterator[tuple[str, Entry]]:
    """Yield the numbers of a picture or a lamp."""
    is_picture = geom.material in papers
    aspect, at = "room.pictures" if is_picture else "room.light", f"scene.xml: geom[@name='{geom.name}']"
    rule = _drawn("on a wall of its own, at eye height" if is_picture else "in a row on the ceiling", aspect)
    sources = [SEED, "room.size"]
    yield (
        f"room.{geom.name}.pos",
        {"value": geom.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"},
    )
    rule = "half of the picture's sides, smaller where the wall is" if is_picture else "that of every lamp"
    yield f"room.{geom.name}.size", {"value": geom.size_m[:2], "unit": "m", "rule": rule, "xml": f"{at}/@size"}
    if is_picture:
        rule = _drawn("from mimoc's", aspect)
        yield f"room.{geom.name}.picture", {"value": papers[geom.material], "rule": rule, "from": [SEED]}


def _trace_crib(world: World) -> Iterator[tuple[str, Entry]]:
    geoms = {geom.name: geom for geom in world.furniture.geoms}
    half_length, half_width, _ = geoms["crib_sheet"].size_m
    rule = (
        f"inside: the common kind's (EN 716-1), or {LENGTH_IN_CHILDREN:g} x the child's length, or as far as it reaches"
    )
    size_m = (2 * half_length, 2 * half_width)
    yield "crib.size", {"value": size_m, "unit": "m", "rule": rule, "from": ["child.length_cm"]}
    rule = f"above the mattress: {RAIL_IN_CHILDREN:.4g} x the child's length, as MIMo's is at 18 months"
    height_m = geoms["crib_rail_front"].pos_m[2]
    yield "crib.rail_height", {"value": height_m, "unit": "m", "rule": rule, "from": ["child.length_cm"]}


def _trace_toy(toy: Prop) -> Iterator[tuple[str, Entry]]:
    key, at = f"toy.{toy.name}", f"scene.xml: body[@name='{toy.name}']"
    rule = _drawn(f"from the toys there are: {toy.source}", "toys.choice")
    yield f"{key}.object", {"value": toy.object, "rule": rule, "from": [SEED]}
    rule = _drawn("as its longest side, between the ends of the range", "toys.size")
    yield f"{key}.size", {"value": toy.size_m, "unit": "m", "rule": rule, "from": [SEED, "spec.scene.toys.size_cm"]}
    yield f"{key}.mass", _mass(toy, [f"{key}.size"])
    rule = _drawn("about where the infant's hands get to, clear of all else", "toys.place")
    sources = [SEED, "spec.scene.pose", f"{key}.size"]
    yield f"{key}.pos", {"value": toy.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"}
    w, _, _, z = toy.quat
    rule = _drawn("from all directions", "toys.orientation")
    yield f"{key}.yaw", {"value": 2 * math.atan2(z, w) % math.tau, "unit": "rad", "rule": rule, "from": [SEED]}
    rule = _drawn("as red, green, blue and opacity", "toys.colour")
    for material in toy.materials:
        xml = f"scene.xml: material[@name='{material.name}']/@rgba"
        tint = material.name.removeprefix(f"{toy.name}_")
        yield f"{key}.colour_{tint}", {"value": material.rgba, "rule": rule, "from": [SEED], "xml": xml}


def _trace_apparatus(prop: Prop) -> Iterator[tuple[str, Entry]]:
    key, at = f"apparatus.{prop.name}", f"scene.xml: body[@name='{prop.name}']"
    sources = ["spec.task.kind", "spec.age_months"]
    yield f"{key}.size", {"value": prop.size_m, "unit": "m", "rule": "that of MIMo's task", "from": sources}
    yield f"{key}.mass", _mass(prop, [f"{key}.size"])
    rule = "where the task begins, by the body of the infant"
    yield f"{key}.pos", {"value": prop.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"}


def _mass(prop: Prop, sources: list[str]) -> Entry:
    volume_cm3 = 1e6 * prop.mass_kg / prop.density_kg_m3
    rule = f"the volume of its shape at this size, {volume_cm3:.4g} cm3, x {prop.density_kg_m3:g} kg/m3"
    xml = f"scene.xml: body[@name='{prop.name}']/geom/@mass"
    return {"value": prop.mass_kg, "unit": "kg", "rule": rule, "from": sources, "xml": xml}
