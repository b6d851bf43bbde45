"""Where the numbers of a room come from."""

from collections.abc import Iterator

from mimoc.body.origins import Entry
from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.furniture import Furniture, WorldGeom
from mimoc.random_streams import SEED, drawn_rule
from mimoc.scenes.built_scene import Placement
from mimoc.scenes.room.sides import SIDES


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
