"""Provenance of the numbers of toys."""

import math
from collections.abc import Iterator, Sequence

from mimoc.body.origins import Entry
from mimoc.mjcf.world import FreeObject
from mimoc.random_streams import SEED, drawn_rule


def trace_toys(toys: Sequence[FreeObject]) -> dict[str, Entry]:
    """Return entries for the number of toys and for each value of each toy, by key in `provenance.json`."""
    rule = drawn_rule("between the ends of the range", "toys.count")
    count = {"value": len(toys), "rule": rule, "from": [SEED, "spec.scene.toys.count"]}
    return {"toys.count": count, **{key: entry for toy in toys for key, entry in _trace_toy(toy)}}


def mass_entry(thing: FreeObject, sources: list[str]) -> Entry:
    """Return the provenance of an object's mass: its volume and density, and the keys they depend on."""
    volume_cm3 = 1e6 * thing.mass_kg / thing.density_kg_m3
    rule = f"volume of its shape at this size, {volume_cm3:.4g} cm3, x density, {thing.density_kg_m3:g} kg/m3"
    xml = f"scene.xml: body[@name='{thing.name}']/geom/@mass"
    return {"value": thing.mass_kg, "unit": "kg", "rule": rule, "from": sources, "xml": xml}


def _trace_toy(toy: FreeObject) -> Iterator[tuple[str, Entry]]:
    key, at = f"toy.{toy.name}", f"scene.xml: body[@name='{toy.name}']"
    rule = drawn_rule(f"from the available toys: {toy.source}", "toys.choice")
    yield f"{key}.object", {"value": toy.object, "rule": rule, "from": [SEED]}
    rule = drawn_rule("as its longest side, between the ends of the range", "toys.size")
    yield f"{key}.size", {"value": toy.size_m, "unit": "m", "rule": rule, "from": [SEED, "spec.scene.toys.size_cm"]}
    yield f"{key}.mass", mass_entry(toy, [f"{key}.size"])
    rule = drawn_rule("around the infant, densest within reach of its hands, without overlaps", "toys.place")
    sources = [SEED, "spec.scene.pose", f"{key}.size"]
    yield f"{key}.pos", {"value": toy.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"}
    w, _, _, z = toy.quat
    rule = drawn_rule("from all directions", "toys.orientation")
    yield f"{key}.yaw", {"value": 2 * math.atan2(z, w) % math.tau, "unit": "rad", "rule": rule, "from": [SEED]}
    rule = drawn_rule("as red, green, blue and opacity", "toys.colour")
    for material in toy.materials:
        xml = f"scene.xml: material[@name='{material.name}']/@rgba"
        tint = material.name.removeprefix(f"{toy.name}_")
        yield f"{key}.colour_{tint}", {"value": material.rgba, "rule": rule, "from": [SEED], "xml": xml}
