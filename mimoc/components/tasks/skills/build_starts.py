"""How the episodes of motor skills begin, and what stands in their worlds: a rail, a table, something in the hand."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import Any

from mimoc.base.geometry.primitives import volume
from mimoc.base.geometry.rotations import Quaternion, matrix_from_axis, quaternion_from_matrix
from mimoc.base.units import rad_to_deg
from mimoc.body.kinematics import FloatArray, body_reaches, frames_in_world
from mimoc.body.poses import Pose, poses_of, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.furniture import Furniture, WorldGeom, WorldMaterial
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.task_setup import Hold, Side, TaskSetup, ball, joints_of, middle_finger, require
from mimoc.components.tasks.free import FreeEntry
from mimoc.components.tasks.skills import CruiseSpec, GraspSpec, PullToStandSpec, SkillSpec
from mimoc.components.tasks.standup.build import build as build_standup
from mimoc.components.tasks.standup.build_grip import curled, grip_point


@dataclass(frozen=True)
class Start:
    """How an episode begins."""

    setup: TaskSetup
    """With any entry."""
    hand: str | None = None
    """The hand that holds an object."""
    object: str | None = None


Begin = Callable[[Any, BodyTree], Start]
"""From the spec of a skill and a body to how an episode begins."""


def lying(name: str) -> Begin:
    """Return how a skill begins in one of the poses of infants, such as `supine`."""

    def begin(task: SkillSpec, tree: BodyTree) -> Start:
        return Start(TaskSetup(FreeEntry(), resting_state(tree, poses_of(tree)[name])))

    return begin


ON_HANDS_AND_KNEES: Mapping[str, float] = {
    "{side}_hip1": -95.0,
    "{side}_knee": -85.0,
    "{side}_foot1": -40.0,
    "{side}_shoulder_horizontal": 80.0,
    "{side}_shoulder_ad_ab": 95.0,
    "{side}_elbow": -5.0,
    "{side}_hand2": 60.0,
    "{side}_fingers": 0.0,
    "head_tilt": -30.0,
}
"""Thighs and arms are upright below a level trunk, in [deg]; joints that do not reach an angle stop short of it."""


def on_hands_and_knees(task: SkillSpec, tree: BodyTree) -> Start:
    """Return how a skill begins on hands and knees."""
    require(tree, task.kind, *(f"{side}_{part}" for side in ("right", "left") for part in ("hand", "lower_leg")))
    return Start(TaskSetup(FreeEntry(), resting_state(tree, Pose(90, ON_HANDS_AND_KNEES, relaxed=False))))


def at_rail(task: PullToStandSpec, tree: BodyTree) -> Start:
    """Return how a skill begins seated on the floor, with the hands at a rail."""
    return Start(build_standup(task, tree))


TABLE_HALF_M, TABLE_TOP_M = (0.15, 0.9), 0.02
"""Half of the sides of a table along x and y, and the thickness of its top."""
WOOD = WorldMaterial("table_wood", (0.82, 0.66, 0.46, 1.0))
AT_TABLE: Mapping[str, float] = {
    "{side}_shoulder_ad_ab": -11.0,
    "{side}_shoulder_rotation": -16.0,
    "{side}_elbow": -97.0,
    "{side}_hand1": 0.0,
    "{side}_fingers": 0.0,
}
"""Upper arms beside the body, forearms level, in [deg]."""
CLEAR_M = 0.01
"""Between the body and a table that it stands before."""
OVER_M = 0.001
"""Between the forearms and the top of the table."""


def at_table(task: CruiseSpec, tree: BodyTree) -> Start:
    """Return how a skill begins standing before a table, with the forearms just above it."""
    require(tree, task.kind, *(f"{side}_{part}" for side in ("right", "left") for part in ("hand", "foot")))
    standing = poses_of(tree)["standing"]
    start = resting_state(tree, replace(standing, angles_deg={**standing.angles_deg, **AT_TABLE}))
    lowest_m, foremost_m = body_reaches(tree, start, (0.0, 0.0, -1.0)), body_reaches(tree, start, (1.0, 0.0, 0.0))
    arms = {name for name in lowest_m if name.endswith(ON_TABLE)}
    top_m = min(-lowest_m[name] for name in arms) - OVER_M
    edge_m = max(foremost_m[name] for name in lowest_m.keys() - arms if -lowest_m[name] < top_m) + CLEAR_M
    half_x_m, half_y_m = TABLE_HALF_M
    middle = (edge_m + half_x_m, 0.0, top_m - TABLE_TOP_M / 2)
    top = WorldGeom("table", "box", (half_x_m, half_y_m, TABLE_TOP_M / 2), middle, (0.0, 0.0, 0.0), WOOD.name)
    taken = (middle[0], 0.0, half_y_m)
    return Start(TaskSetup(FreeEntry(), start, furniture=Furniture((top,), (WOOD,)), taken=(taken,)))


ON_TABLE = ("_lower_arm", "_hand", "_fingers")
"""What the names of bodies end with that lie on a table; other fingers belong to hands with five."""


HOLDING: Mapping[str, float] = {
    "{side}_hip1": -95.0,
    "{side}_hip2": -33.0,
    "{side}_knee": -25.0,
    "{side}_shoulder_ad_ab": -11.0,
    "{side}_shoulder_rotation": -16.0,
    "{side}_elbow": -97.0,
    "{side}_hand1": 90.0,
}
"""Seated, upper arms beside the body, forearms level, palms down, in [deg]."""
ROD_RADIUS_M, ROD_HALF_M, CUBE_HALF_M, OBJECT_KG = 0.008, 0.04, 0.0125, 0.05
OPEN = 0.25
"""How far fingers are bent at first, as a share of what closes them around a bar."""
OBJECT = "held"


def holding(task: GraspSpec, tree: BodyTree) -> Start:
    """Return how a skill begins with an object below a palm; only wrist and fingers move, and the hip is held."""
    side: Side = task.hand or "right"
    hand = f"{side}_hand"
    require(tree, task.kind, hand, middle_finger(tree, side))
    opened = {name.removeprefix("robot:"): OPEN * rad_to_deg(angle) for name, angle in curled(tree, side).items()}
    start = resting_state(tree, Pose(0, {**HOLDING, **opened}, relaxed=False))
    origin_m, turn = frames_in_world(tree, start)[hand]
    radius_m = ROD_RADIUS_M if task.object == "rod" else CUBE_HALF_M
    place_m = origin_m + turn @ grip_point(tree, side, radius_m)
    thing = _thing(task.object, place_m, quaternion_from_matrix(turn @ matrix_from_axis((0.0, 1.0, 0.0), pi / 2)))
    moved = joints_of(tree, hand)
    locked = [joint for joint in tree.joints if joint not in moved]
    setup = TaskSetup(FreeEntry(), start, moved, locked, (Hold("hip"),), (thing,))
    return Start(setup, middle_finger(tree, side), thing.name)


def _thing(kind: str, place_m: FloatArray, quat: Quaternion) -> FreeObject:
    """Return a wooden rod along z, or a cube, at a place in the world, shape (3,), [m]."""
    x, y, z = place_m.tolist()
    model = ball((x, y, z))
    shape, size_m = ("capsule", (ROD_RADIUS_M, ROD_HALF_M)) if kind == "rod" else ("box", (CUBE_HALF_M,) * 3)
    geom = replace(model.geoms[0], name=kind, type=shape, sizes=(("size", size_m),), mass_kg=OBJECT_KG)
    length_m = 2 * (ROD_HALF_M + ROD_RADIUS_M) if kind == "rod" else 2 * CUBE_HALF_M
    volume_m3 = volume(shape, size_m)
    return replace(
        model,
        name=OBJECT,
        object=kind,
        category=kind,
        joint=f"{OBJECT}_joint",
        quat=quat,
        size_m=length_m,
        mass_kg=OBJECT_KG,
        density_kg_m3=OBJECT_KG / volume_m3,
        geoms=(geom,),
    )
