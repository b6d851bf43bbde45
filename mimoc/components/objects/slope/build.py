"""A slope, and an infant that lies on it."""

import math
from collections.abc import Mapping

import numpy as np

from mimoc.base.geometry.rotations import quaternion_from_axis
from mimoc.base.units import cm_to_m, deg_to_rad
from mimoc.body.tree import BodyTree
from mimoc.compiler.objects.boards import ACROSS, board, finish, fixed_object
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.starts import FurnitureStart, State, turned
from mimoc.components.objects.slope import SlopeSpec

THICKNESS_M = 0.02


def build(spec: SlopeSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a slope: a board, and a wall below its high end."""
    name, wood = object_name(spec.name), finish(object_name(spec.name), spec.colour)
    half_m, half_y_m, angle_rad = cm_to_m(spec.length_cm) / 2, cm_to_m(spec.width_cm) / 2, deg_to_rad(spec.angle_deg)
    rise_m = half_m * math.sin(angle_rad)
    down_m = THICKNESS_M / 2 * np.array([-math.sin(angle_rad), 0.0, math.cos(angle_rad)])
    pieces = [
        board(f"{name}_top", (half_m, half_y_m, THICKNESS_M / 2), (0.0, 0.0, rise_m) - down_m, wood, spec.angle_deg)
    ]
    under_m = 2 * rise_m - 2 * THICKNESS_M
    if under_m > 0:
        half_under_m = (THICKNESS_M / 2, half_y_m, under_m / 2)
        end_m = (half_m * math.cos(angle_rad) - THICKNESS_M, 0.0, under_m / 2)
        pieces.append(board(f"{name}_end", half_under_m, end_m, wood))
    return fixed_object(name, pieces, (wood,), "wood")


def start(spec: SlopeSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts on the middle of the slope: as on the floor, turned with it."""
    up_rad = deg_to_rad(spec.angle_deg)
    middle_m = (0.0, 0.0, cm_to_m(spec.length_cm) / 2 * math.sin(up_rad))
    turn = quaternion_from_axis(ACROSS, -up_rad)
    return FurnitureStart({pose: turned(state, turn, middle_m) for pose, state in states.items()})
