"""Furniture made of boards, and an infant that starts on it, at it or in it."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import Vec3, quaternion_from_axis
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray, body_reaches, frames_in_world, hip_in_world
from mimoc.body.origins import Entry
from mimoc.body.poses import poses_of, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import RAIL_IN_CHILDREN, RAIL_RADIUS_M, WorldMaterial, rail_height
from mimoc.compiler.objects.boards import (
    ACROSS,
    UNTURNED,
    Surface,
    bar,
    board,
    finish,
    fixed_object,
    post,
    seen,
    show,
    softened,
)
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.placing import FurnitureStart, State, turned
from mimoc.compiler.task_setup import Hold, Side
from mimoc.components.objects import (
    MatSpec,
    RailSpec,
    ScreenSpec,
    SlopeSpec,
    StairsSpec,
    TableSpec,
    WallSpec,
    WaterSpec,
)
from mimoc.components.tasks.skills.build import AT_TABLE, CLEAR_M, ON_TABLE, OVER_M
from mimoc.components.tasks.standup.build import KNUCKLES, THUMBS_INSIDE, arm_length, arm_to_bar, curled, grip_point
from mimoc.schema.names import SIDES
from mimoc.schema.objects import WATER_KG_M3, WaterEntry


def build_mat(spec: MatSpec, surroundings: Surroundings) -> BuiltObject:
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


def start_mat(spec: MatSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts on the middle of the mat, in each of its poses."""
    top_m = (0.0, 0.0, cm_to_m(spec.thickness_cm))
    return FurnitureStart({pose: turned(state, UNTURNED, top_m) for pose, state in states.items()})


RAIL_POST_M, BAR_GAP_M = 0.015, 0.01  # Radius of its posts, and least gap between the bar and the body.
BENT_ARM = 0.8  # How far it is from a shoulder to the rail, in lengths of the shorter arm.


def build_rail(spec: RailSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a rail: a bar along y across two posts."""
    name = object_name(spec.name)
    wood = finish(object_name(spec.name), spec.colour)
    half_m = cm_to_m(spec.width_cm) / 2
    height_m = bar_height(spec, surroundings.tree)
    pieces = [bar(f"{name}_bar", half_m, (0.0, 0.0, height_m), wood)]
    for side, y_m in ("left", half_m), ("right", -half_m):
        pieces.append(post(f"{name}_post_{side}", RAIL_POST_M, height_m, (0.0, y_m), wood))
    rule = f"given by the spec, or {RAIL_IN_CHILDREN:.4g} x the child's length, as that of its crib"
    sources = ["spec.scene.objects", "child.length_cm"]
    origins: Mapping[str, Entry] = {"height": {"value": height_m, "unit": "m", "rule": rule, "from": sources}}
    return fixed_object(name, pieces, (wood,), "wood", origins=origins)


def bar_height(spec: RailSpec, tree: BodyTree) -> float:
    """Return the height of the middle of the bar, in [m]."""
    return rail_height(tree) if spec.bar_cm is None else cm_to_m(spec.bar_cm)


def start_rail(spec: RailSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant stands before the rail, its hands closed around it.

    Raises:
        UnsupportedTaskError: If it has no hands, or if they do not get there.
    """
    if not {f"{side}_{KNUCKLES.get(tree.hands, 'fingers')}" for side in SIDES} <= {body.name for body in tree.bodies}:
        raise UnsupportedTaskError("an infant starts at a rail with both hands on it, and this one lacks one")
    standing, height_m = states["standing"], bar_height(spec, tree)
    hip_m, turn = hip_in_world(standing)
    angles = dict(zip(tree.joints, standing[7:], strict=True))
    shoulders: dict[Side, FloatArray] = {
        side: frames_in_world(tree, standing)[f"{side}_upper_arm"][0] for side in SIDES
    }
    grips: dict[Side, Vec3] = {side: grip_point(tree, side, RAIL_RADIUS_M) for side in SIDES}
    ahead_m = max(_arm_ahead(tree, shoulders, grips, height_m), _body_ahead(tree, standing, height_m))
    for side in SIDES:
        place_m = np.array([ahead_m, float(shoulders[side][1]), height_m])
        angles |= curled(tree, side)
        to_bar = turn.T @ (place_m - hip_m), turn.T @ THUMBS_INSIDE[side]
        angles |= arm_to_bar(tree, angles, side, grips[side], *to_bar)
    holds = tuple(Hold(f"{side}_hand", grips[side], turns=True) for side in SIDES) if spec.grip else ()
    return FurnitureStart({"standing": (*standing[:7], *(angles[joint] for joint in tree.joints))}, ahead_m, holds)


def _arm_ahead(
    tree: BodyTree, shoulders: Mapping[Side, FloatArray], grips: Mapping[Side, Vec3], height_m: float
) -> float:
    """Return how far before the hip the bar is with somewhat bent arms, in [m]."""
    distances_m = list[float]()
    for side, shoulder in shoulders.items():
        level_m2 = (BENT_ARM * arm_length(tree, side, grips[side])) ** 2 - (height_m - float(shoulder[2])) ** 2
        distances_m.append(float(shoulder[0]) + math.sqrt(max(level_m2, 0.0)))
    return min(distances_m)


def _body_ahead(tree: BodyTree, state: State, height_m: float) -> float:
    """Return how far before the hip the bar is at least, in [m]: clear of trunk, head and legs."""
    lowest_m = body_reaches(tree, state, (0.0, 0.0, -1.0))
    foremost_m = body_reaches(tree, state, (1.0, 0.0, 0.0))
    highest_m = body_reaches(tree, state, (0.0, 0.0, 1.0))
    groups, near_m = tree.body_groups, RAIL_RADIUS_M + BAR_GAP_M
    beside = [
        name
        for name in foremost_m
        if not groups[name].endswith(("_arm", "_hand"))
        and -lowest_m[name] - near_m < height_m < highest_m[name] + near_m
    ]
    return max((foremost_m[name] for name in beside), default=-math.inf) + near_m


TABLE_TOP_M, TABLE_LEG_M = 0.02, 0.04  # Thickness of its top, and of its legs.


def build_table(spec: TableSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a table: its top, and a leg at each corner."""
    name = object_name(spec.name)
    wood = finish(object_name(spec.name), spec.colour)
    half_x_m, half_y_m = (cm_to_m(side) / 2 for side in spec.sides_cm)
    top_m = cm_to_m(spec.top_cm)
    thickness_m = min(TABLE_TOP_M, top_m / 2)
    leg_m = (top_m - thickness_m) / 2
    thin_m = min(TABLE_LEG_M / 2, half_x_m / 2, half_y_m / 2)
    pieces = [board(f"{name}_top", (half_x_m, half_y_m, thickness_m / 2), (0.0, 0.0, top_m - thickness_m / 2), wood)]
    for end, x in ("far", half_x_m - thin_m), ("near", thin_m - half_x_m):
        for side, y in ("left", half_y_m - thin_m), ("right", thin_m - half_y_m):
            pieces.append(board(f"{name}_leg_{end}_{side}", (thin_m, thin_m, leg_m), (x, y, leg_m), wood))
    return fixed_object(name, pieces, (wood,), "wood", Surface((half_x_m, half_y_m), top_m))


def start_table(spec: TableSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant stands before the table, its forearms level above it unless it is too high."""
    top_m = cm_to_m(spec.top_cm)
    standing = poses_of(tree)["standing"]
    over = resting_state(tree, replace(standing, angles_deg={**standing.angles_deg, **AT_TABLE}))
    for state, over_table in (over, ON_TABLE), (states["standing"], ()):
        lowest_m, foremost_m = (body_reaches(tree, state, (x, 0.0, x - 1.0)) for x in (0.0, 1.0))
        below = [name for name, reach_m in lowest_m.items() if -reach_m < top_m + OVER_M]
        if not any(name.endswith(over_table) for name in below):
            break
    edge_m = max(foremost_m[name] for name in below) + CLEAR_M
    return FurnitureStart({"standing": state}, edge_m + cm_to_m(spec.sides_cm[0]) / 2)


def build_stairs(spec: StairsSpec, surroundings: Surroundings) -> BuiltObject:
    """Return stairs: a box from the floor for each step."""
    name = object_name(spec.name)
    wood = finish(object_name(spec.name), spec.colour)
    rise_m = cm_to_m(spec.rise_cm)
    run_m = cm_to_m(spec.run_cm)
    half_y_m = cm_to_m(spec.width_cm) / 2
    pieces = []
    for number in range(1, spec.steps + 1):
        x_m = (number - (spec.steps + 1) / 2) * run_m
        half_z_m = number * rise_m / 2
        pieces.append(board(f"{name}_{number}", (run_m / 2, half_y_m, half_z_m), (x_m, 0.0, half_z_m), wood))
    return fixed_object(name, pieces, (wood,), "wood")


SLOPE_THICKNESS_M = 0.02


def build_slope(spec: SlopeSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a slope: a board, and a wall below its high end."""
    name = object_name(spec.name)
    wood = finish(object_name(spec.name), spec.colour)
    half_m = cm_to_m(spec.length_cm) / 2
    half_y_m = cm_to_m(spec.width_cm) / 2
    angle_rad = math.radians(spec.angle_deg)
    rise_m = half_m * math.sin(angle_rad)
    down_m = SLOPE_THICKNESS_M / 2 * np.array([-math.sin(angle_rad), 0.0, math.cos(angle_rad)])
    pieces = [
        board(
            f"{name}_top", (half_m, half_y_m, SLOPE_THICKNESS_M / 2), (0.0, 0.0, rise_m) - down_m, wood, spec.angle_deg
        )
    ]
    under_m = 2 * rise_m - 2 * SLOPE_THICKNESS_M
    if under_m > 0:
        half_under_m = (SLOPE_THICKNESS_M / 2, half_y_m, under_m / 2)
        end_m = (half_m * math.cos(angle_rad) - SLOPE_THICKNESS_M, 0.0, under_m / 2)
        pieces.append(board(f"{name}_end", half_under_m, end_m, wood))
    return fixed_object(name, pieces, (wood,), "wood")


def start_slope(spec: SlopeSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts on the middle of the slope: as on the floor, turned with it."""
    up_rad = math.radians(spec.angle_deg)
    middle_m = (0.0, 0.0, cm_to_m(spec.length_cm) / 2 * math.sin(up_rad))
    turn = quaternion_from_axis(ACROSS, -up_rad)
    return FurnitureStart({pose: turned(state, turn, middle_m) for pose, state in states.items()})


def build_wall(spec: WallSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a wall: a box, and its picture."""
    name = object_name(spec.name)
    paint = finish(object_name(spec.name), spec.colour)
    half_m = cm_to_m(spec.thickness_cm) / 2, cm_to_m(spec.width_cm) / 2, cm_to_m(spec.tall_cm) / 2
    pictures, looks = show(name, spec, surroundings.folder, (-half_m[0], 0.0, half_m[2]), glows=False)
    box = board(name, half_m, (0.0, 0.0, half_m[2]), paint)
    return fixed_object(name, (box, *pictures), (paint,), "wood", pictures=looks)


SCREEN_THICKNESS_M, SCREEN_POST_M, SCREEN_FOOT_M = 0.02, 0.02, 0.01
"""Thickness of the panel, breadth of the post behind it, and thickness of its foot."""
SCREEN_FOOT = 0.4  # Length of its foot, for one width of the screen.


def build_screen(spec: ScreenSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a screen: a panel, its picture, and a stand."""
    name = object_name(spec.name)
    paint = finish(object_name(spec.name), spec.colour)
    half_y_m = cm_to_m(spec.width_cm) / 2
    half_z_m = cm_to_m(spec.tall_cm) / 2
    z_m = cm_to_m(spec.middle_cm)
    pictures, looks = show(name, spec, surroundings.folder, (-SCREEN_THICKNESS_M / 2, 0.0, z_m), glows=True)
    half_post_m = SCREEN_POST_M / 2
    half_foot_m = SCREEN_FOOT * half_y_m
    behind_m = SCREEN_THICKNESS_M / 2 + half_post_m
    pieces = (
        board(name, (SCREEN_THICKNESS_M / 2, half_y_m, half_z_m), (0.0, 0.0, z_m), paint),
        board(f"{name}_post", (half_post_m, half_post_m, z_m / 2), (behind_m, 0.0, z_m / 2), paint),
        board(f"{name}_foot", (half_foot_m, half_foot_m, SCREEN_FOOT_M / 2), (behind_m, 0.0, SCREEN_FOOT_M / 2), paint),
    )
    return fixed_object(name, (*pieces, *pictures), (paint,), "wood", pictures=looks)


WATER_OPACITY = 0.35  # Opacity of its colour: the infant in it is seen.
WATER_SEEN_ABOVE_M = 0.001
"""How far above the bottom it is seen, so that its bottom and the floor are not drawn in the same place."""


def build_water(spec: WaterSpec, surroundings: Surroundings) -> BuiltObject:
    """Return water: a box that is only seen, and what the runtime must know to let it act."""
    name, depth_m = object_name(spec.name), cm_to_m(spec.depth_cm)
    half_x_m, half_y_m = (cm_to_m(side) / 2 for side in spec.sides_cm)
    looks = WorldMaterial(name, (*spec.colour, WATER_OPACITY), specular=0.6, shininess=0.6)
    half_z_m = (depth_m - WATER_SEEN_ABOVE_M) / 2
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


def start_water(spec: WaterSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts in the middle of the water: in each of its poses, on the floor."""
    return FurnitureStart(states)
