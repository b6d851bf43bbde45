"""A table, and an infant that stands before it."""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import body_reaches
from mimoc.body.poses import poses_of, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.objects.boards import Surface, board, finish, fixed_object
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.starts import FurnitureStart, State
from mimoc.components.objects.table import TableSpec
from mimoc.components.tasks.skills.build_starts import AT_TABLE, CLEAR_M, ON_TABLE, OVER_M

TOP_M, LEG_M = 0.02, 0.04
"""Thickness of its top, and of its legs."""


def build(spec: TableSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a table: its top, and a leg at each corner."""
    name, wood = object_name(spec.name), finish(object_name(spec.name), spec.colour)
    half_x_m, half_y_m = (cm_to_m(side) / 2 for side in spec.sides_cm)
    top_m = cm_to_m(spec.top_cm)
    thickness_m = min(TOP_M, top_m / 2)
    leg_m = (top_m - thickness_m) / 2
    thin_m = min(LEG_M / 2, half_x_m / 2, half_y_m / 2)
    pieces = [board(f"{name}_top", (half_x_m, half_y_m, thickness_m / 2), (0.0, 0.0, top_m - thickness_m / 2), wood)]
    for end, x in ("far", half_x_m - thin_m), ("near", thin_m - half_x_m):
        for side, y in ("left", half_y_m - thin_m), ("right", thin_m - half_y_m):
            pieces.append(board(f"{name}_leg_{end}_{side}", (thin_m, thin_m, leg_m), (x, y, leg_m), wood))
    return fixed_object(name, pieces, (wood,), "wood", Surface((half_x_m, half_y_m), top_m))


def start(spec: TableSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant stands before the table, its forearms level above it unless it is too high."""
    top_m, standing = cm_to_m(spec.top_cm), poses_of(tree)["standing"]
    over = resting_state(tree, replace(standing, angles_deg={**standing.angles_deg, **AT_TABLE}))
    for state, over_table in (over, ON_TABLE), (states["standing"], ()):
        lowest_m, foremost_m = (body_reaches(tree, state, (x, 0.0, x - 1.0)) for x in (0.0, 1.0))
        below = [name for name, reach_m in lowest_m.items() if -reach_m < top_m + OVER_M]
        if not any(name.endswith(over_table) for name in below):
            break
    edge_m = max(foremost_m[name] for name in below) + CLEAR_M
    return FurnitureStart({"standing": state}, edge_m + cm_to_m(spec.sides_cm[0]) / 2)
