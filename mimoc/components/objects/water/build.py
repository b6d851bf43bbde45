"""A block of water, and an infant in it."""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.base.units import cm_to_m
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.furniture import WorldMaterial
from mimoc.compiler.objects.boards import Surface, board, fixed_object, seen
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.starts import FurnitureStart, State
from mimoc.components.objects.water import WaterSpec
from mimoc.schema.object_base import WATER_KG_M3, WaterEntry

OPACITY = 0.35
"""Of its colour: the infant in it is seen."""
SEEN_ABOVE_M = 0.001
"""How far above the bottom it is seen, so that its bottom and the floor are not drawn in the same place."""


def build(spec: WaterSpec, surroundings: Surroundings) -> BuiltObject:
    """Return water: a box that is only seen, and what the runtime must know to let it act."""
    name, depth_m = object_name(spec.name), cm_to_m(spec.depth_cm)
    half_x_m, half_y_m = (cm_to_m(side) / 2 for side in spec.sides_cm)
    looks = WorldMaterial(name, (*spec.colour, OPACITY), specular=0.6, shininess=0.6)
    half_z_m = (depth_m - SEEN_ABOVE_M) / 2
    box = seen(board(name, (half_x_m, half_y_m, half_z_m), (0.0, 0.0, depth_m - half_z_m), looks))
    origin: Entry = {
        "value": spec.infant_kg_m3,
        "unit": "kg/m3",
        "rule": "as the spec gives it; by default an assumption: tissue of 1030 with some air in the lungs",
        "from": ["spec.scene.objects"],
    }
    block = fixed_object(
        name, (box,), (looks,), "cloth", Surface((half_x_m, half_y_m), depth_m), origins={"infant_kg_m3": origin}
    )
    mass_kg = WATER_KG_M3 * 4 * half_x_m * half_y_m * depth_m
    water = WaterEntry(half_sides_m=(half_x_m, half_y_m), depth_m=depth_m, infant_kg_m3=spec.infant_kg_m3)
    return replace(block, material="water", mass_kg=mass_kg, water=water)


def start(spec: WaterSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts in the middle of the water: in each of its poses, on the floor."""
    return FurnitureStart(states)
