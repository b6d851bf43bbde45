"""A soft mat, and an infant on it."""

from collections.abc import Mapping

from mimoc.base.units import cm_to_m
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.objects.boards import UNTURNED, Surface, board, finish, fixed_object, softened
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.starts import FurnitureStart, State, turned
from mimoc.components.objects.mat import MatSpec


def build(spec: MatSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a mat: one soft box."""
    name, height_m = object_name(spec.name), cm_to_m(spec.thickness_cm)
    half_x_m, half_y_m = (cm_to_m(side) / 2 for side in spec.sides_cm)
    foam = finish(name, spec.colour, specular=0.0)
    box = board(name, (half_x_m, half_y_m, height_m / 2), (0.0, 0.0, height_m / 2), foam)
    piece = softened(box, cm_to_m(spec.sink_cm))
    rule = "time constant with which what rests on one point sinks in by sink_cm (mimoc/compiler/objects/boards.py)"
    solref: Entry = {"value": piece.solref[0], "unit": "s", "rule": rule, "from": ["spec.scene.objects"]}
    surface = Surface((half_x_m, half_y_m), height_m)
    return fixed_object(name, (piece,), (foam,), "cloth", surface, origins={"solref": solref})


def start(spec: MatSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts on the middle of the mat, in each of its poses."""
    top_m = (0.0, 0.0, cm_to_m(spec.thickness_cm))
    return FurnitureStart({pose: turned(state, UNTURNED, top_m) for pose, state in states.items()})
