"""A rail, and an infant that stands at it and holds on."""

import math
from collections.abc import Mapping

import numpy as np

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import Vec3
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray, body_reaches, frames, frames_in_world, hip_in_world
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.furniture import RAIL_IN_CHILDREN, RAIL_RADIUS_M, rail_height
from mimoc.compiler.objects.boards import bar, finish, fixed_object, post
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.placing import FurnitureStart, State
from mimoc.compiler.task_setup import Hold, Side
from mimoc.components.objects.furniture import RailSpec
from mimoc.components.tasks.standup.build import KNUCKLES, arm_to_bar, curled, grip_point
from mimoc.schema.names import SIDES

POST_RADIUS_M, CLEAR_M = 0.015, 0.01  # Of its posts, and least gap between the bar and the body.
BENT = 0.8  # How far it is from a shoulder to the rail, in lengths of the shorter arm.


def build(spec: RailSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a rail: a bar along y across two posts."""
    name, wood = object_name(spec.name), finish(object_name(spec.name), spec.colour)
    half_m, height_m = cm_to_m(spec.width_cm) / 2, bar_height(spec, surroundings.tree)
    pieces = [bar(f"{name}_bar", half_m, (0.0, 0.0, height_m), wood)]
    for side, y_m in ("left", half_m), ("right", -half_m):
        pieces.append(post(f"{name}_post_{side}", POST_RADIUS_M, height_m, (0.0, y_m), wood))
    rule = f"given by the spec, or {RAIL_IN_CHILDREN:.4g} x the child's length, as that of its crib"
    sources = ["spec.scene.objects", "child.length_cm"]
    origins: Mapping[str, Entry] = {"height": {"value": height_m, "unit": "m", "rule": rule, "from": sources}}
    return fixed_object(name, pieces, (wood,), "wood", origins=origins)


def bar_height(spec: RailSpec, tree: BodyTree) -> float:
    """Return the height of the middle of the bar, in [m]."""
    return rail_height(tree) if spec.bar_cm is None else cm_to_m(spec.bar_cm)


def start(spec: RailSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
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
        along = (0.0, 1.0 if side == "right" else -1.0, 0.0)  # The thumbs are on the inside.
        place_m = np.array([ahead_m, float(shoulders[side][1]), height_m])
        angles |= curled(tree, side)
        angles |= arm_to_bar(tree, angles, side, grips[side], turn.T @ (place_m - hip_m), turn.T @ along)
    holds = tuple(Hold(f"{side}_hand", grips[side], turns=True) for side in SIDES) if spec.grip else ()
    return FurnitureStart({"standing": (*standing[:7], *(angles[joint] for joint in tree.joints))}, ahead_m, holds)


def _arm_ahead(
    tree: BodyTree, shoulders: Mapping[Side, FloatArray], grips: Mapping[Side, Vec3], height_m: float
) -> float:
    """Return how far before the hip the bar is with somewhat bent arms, in [m]."""
    straight, distances_m = frames(tree, {}), list[float]()
    for side, shoulder in shoulders.items():
        origin, turn = straight[f"{side}_hand"]
        arm_m = float(np.linalg.norm(origin + turn @ grips[side] - straight[f"{side}_upper_arm"][0]))
        level_m2 = (BENT * arm_m) ** 2 - (height_m - float(shoulder[2])) ** 2
        distances_m.append(float(shoulder[0]) + math.sqrt(max(level_m2, 0.0)))
    return min(distances_m)


def _body_ahead(tree: BodyTree, state: State, height_m: float) -> float:
    """Return how far before the hip the bar is at least, in [m]: clear of trunk, head and legs."""
    lowest_m, foremost_m = body_reaches(tree, state, (0.0, 0.0, -1.0)), body_reaches(tree, state, (1.0, 0.0, 0.0))
    highest_m = body_reaches(tree, state, (0.0, 0.0, 1.0))
    groups, near_m = tree.body_groups, RAIL_RADIUS_M + CLEAR_M
    beside = [
        name
        for name in foremost_m
        if not groups[name].endswith(("_arm", "_hand"))
        and -lowest_m[name] - near_m < height_m < highest_m[name] + near_m
    ]
    return max((foremost_m[name] for name in beside), default=-math.inf) + near_m
