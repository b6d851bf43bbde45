"""How an infant starts on, in or at furniture."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import Quaternion, Vec3, matrix_from_quaternion, quaternion_product
from mimoc.base.kinds import function_of
from mimoc.base.units import cm_to_m, deg_to_rad, m_to_cm, rad_to_deg
from mimoc.body.tree import BodyTree
from mimoc.compiler.scenes.built_scene import Placement
from mimoc.compiler.task_setup import Hold
from mimoc.schema.components.objects import OBJECTS
from mimoc.schema.object_base import ObjectSpec, PointSpec
from mimoc.schema.scene import SceneSpec

State = tuple[float, ...]
"""Position and quaternion of the hip, then the hinges (qpos)."""


@dataclass(frozen=True, slots=True)
class FurnitureStart:
    """How an infant can start at a piece of furniture, in the frame of the infant: x ahead, floor at z = 0."""

    states: Mapping[str, State]
    """By the name of its pose; the hip is at x = y = 0."""
    ahead_m: float = 0.0
    """How far ahead of the hip the origin of the furniture is."""
    holds: tuple[Hold, ...] = ()
    """What holds on, or is held."""


def turned(state: State, turn: Quaternion, middle_m: Vec3) -> State:
    """Return a state on another plane than the floor: turned about the world's origin, which is then moved."""
    w, i, j, k = state[3:7]
    x, y, z = (matrix_from_quaternion(turn) @ state[:3] + middle_m).tolist()
    return (x, y, z, *quaternion_product(turn, (w, i, j, k)), *state[7:])


def start_at(scene: SceneSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts at the furniture that its scene names.

    Args:
        scene: The scene.
        tree: The infant's body.
        states: Its poses on the floor, by name.

    Raises:
        UnsupportedTaskError: If this infant cannot start there, or lacks a part that a belt holds.
    """
    item = next(item for item in scene.objects if item.name == scene.start_at)
    start = OBJECTS[item.kind].start
    assert start is not None  # The spec was checked.
    try:
        at: FurnitureStart = function_of(start, "start")(item, tree, states)
    except UnsupportedTaskError as error:
        raise UnsupportedTaskError(str(error), ("scene", "start_at")) from None
    bodies = {body.name for body in tree.bodies}
    if missing := sorted(hold.body for hold in at.holds if hold.body not in bodies):
        raise UnsupportedTaskError(f"this infant has no '{missing[0]}' to hold", ("scene", "start_at"))
    return replace(at, states={pose: state for pose, state in at.states.items() if pose in OBJECTS[item.kind].poses})


def place_furniture(scene: SceneSpec, start: Placement, ahead_m: float) -> tuple[Sequence[ObjectSpec], Placement]:
    """Return the objects of a scene, and where its infant is, who starts at one of them.

    Furniture with coordinates takes the infant to itself; furniture without a place comes to the infant.

    Args:
        scene: The scene.
        start: Where the infant would be without.
        ahead_m: How far ahead of it the furniture is.
    """
    number = next((number for number, item in enumerate(scene.objects) if item.name == scene.start_at), None)
    if number is None:
        return scene.objects, start
    item = scene.objects[number]
    if isinstance(item.at, PointSpec):
        yaw_rad = deg_to_rad(item.yaw_deg)
        x_m, y_m = cm_to_m(item.at.x_cm), cm_to_m(item.at.y_cm)
        start = Placement(x_m - ahead_m * math.cos(yaw_rad), y_m - ahead_m * math.sin(yaw_rad), yaw_rad)
    else:
        x_m, y_m = start.x_m + ahead_m * math.cos(start.yaw_rad), start.y_m + ahead_m * math.sin(start.yaw_rad)
    at = PointSpec(x_cm=m_to_cm(x_m), y_cm=m_to_cm(y_m), z_cm=0.0)
    placed = item.model_copy(update={"at": at, "yaw_deg": rad_to_deg(start.yaw_rad)})
    return (*scene.objects[:number], placed, *scene.objects[number + 1 :]), start
