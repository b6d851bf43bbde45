"""Stairs."""

from mimoc.base.units import cm_to_m
from mimoc.compiler.objects.boards import board, finish, fixed_object
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.components.objects.stairs import StairsSpec


def build(spec: StairsSpec, surroundings: Surroundings) -> BuiltObject:
    """Return stairs: a box from the floor for each step."""
    name, wood = object_name(spec.name), finish(object_name(spec.name), spec.colour)
    rise_m, run_m, half_y_m = cm_to_m(spec.rise_cm), cm_to_m(spec.run_cm), cm_to_m(spec.width_cm) / 2
    pieces = []
    for number in range(1, spec.steps + 1):
        x_m, half_z_m = (number - (spec.steps + 1) / 2) * run_m, number * rise_m / 2
        pieces.append(board(f"{name}_{number}", (run_m / 2, half_y_m, half_z_m), (x_m, 0.0, half_z_m), wood))
    return fixed_object(name, pieces, (wood,), "wood")
