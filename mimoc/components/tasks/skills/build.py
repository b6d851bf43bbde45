"""The setups of motor skills: how each begins, what stands in its world, and what its entry says.

Heights, distances and forces follow the child's body. The bounds are of the posture that an examiner would ask for
(Bayley's and the AIMS's items in their words; their numbers are assumptions), those of rewards only lead there.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import pi, sin
from typing import Any, Literal

from mimoc.base.geometry.primitives import volume
from mimoc.base.geometry.rotations import Quaternion, matrix_from_axis, quaternion_from_matrix
from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.body.kinematics import FloatArray, body_reaches, frames, frames_in_world
from mimoc.body.poses import Pose, poses_of, resting_state, standing_height
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import Furniture, WorldGeom, WorldMaterial
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.task_setup import Hold, Side, TaskSetup, ball, joints_of, middle_finger, require
from mimoc.components.tasks.free import FreeEntry
from mimoc.components.tasks.skills import (
    STEP_MS,
    BoundEntry,
    CruiseSpec,
    GraspSpec,
    Measure,
    PullToStandSpec,
    RewardEntry,
    ShareEntry,
    SkillEntry,
    SkillSpec,
)
from mimoc.components.tasks.standup.build import build as build_standup, curled, grip_point


@dataclass(frozen=True)
class Start:
    """How an episode begins."""

    setup: TaskSetup  # With any entry.
    hand: str | None = None  # The hand that holds an object.
    object: str | None = None


Begin = Callable[[Any, BodyTree], Start]  # From the spec of a skill and a body to how an episode begins.


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
CLEAR_M = 0.01  # Between the body and a table that it stands before.
OVER_M = 0.001  # Between the forearms and the top of the table.


def at_table(task: CruiseSpec, tree: BodyTree) -> Start:
    """Return how a skill begins standing before a table, with the forearms just above it."""
    require(tree, task.kind, *(f"{side}_{part}" for side in ("right", "left") for part in ("hand", "foot")))
    standing = poses_of(tree)["standing"]
    start = resting_state(tree, replace(standing, angles_deg={**standing.angles_deg, **AT_TABLE}))
    lowest_m = body_reaches(tree, start, (0.0, 0.0, -1.0))
    foremost_m = body_reaches(tree, start, (1.0, 0.0, 0.0))
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
OPEN = 0.25  # How far fingers are bent at first, as a share of what closes them around a bar.
OBJECT = "held"


def holding(task: GraspSpec, tree: BodyTree) -> Start:
    """Return how a skill begins with an object below a palm; only wrist and fingers move, and the hip is held."""
    side: Side = task.hand or "right"
    hand = f"{side}_hand"
    require(tree, task.kind, hand, middle_finger(tree, side))
    opened = {name.removeprefix("robot:"): OPEN * math.degrees(angle) for name, angle in curled(tree, side).items()}
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


Shares = Mapping[Measure, tuple[float, float]]
"""Shares of a term of the reward, by measure: the values at which the share is 0 and 1."""


@dataclass(frozen=True)
class Skill:
    """What an infant has to do."""

    duration_s: float  # Duration of an episode.
    posture: Mapping[Measure, float]  # The least of each measure in a posture that counts.
    reward: Mapping[str, tuple[float, Shares]]  # Weight and shares of each term of the reward, by its name.
    begin: Begin  # Returns how it begins, without an entry.
    clear: tuple[str, ...] = ()  # Groups of bodies that press on nothing in such a posture.
    kept_s: float = 0.0
    way_m: float = 0.0
    fall: Mapping[Measure, float] = field(default_factory=dict)
    """The least of each measure with which the episode goes on."""
    way: Literal["forward", "left"] = "forward"
    forward_axis: Literal[0, 2] = 0


ROLLED = sin(math.radians(60.0))
"""Hip and chest face down by 60 degrees or more, as in the search for a roll of `mimoc.studies`."""
TRUNK, HEAD = ("hip", "lower_body", "upper_body", "chest"), ("head",)
ARMS = tuple(f"{side}_{part}" for side in ("right", "left") for part in ("upper_arm", "lower_arm"))
HANDS = tuple(f"{side}_hand" for side in ("right", "left"))
LEGS = tuple(f"{side}_{part}" for side in ("right", "left") for part in ("upper_leg", "lower_leg"))
ALL_BUT_FEET = (*TRUNK, *HEAD, *ARMS, *HANDS, *LEGS)
STANDING: Mapping[str, tuple[float, Shares]] = {"standing": (1.0, {"hip_height": (0.4, 0.95), "upright": (0.2, 0.95)})}
FALLEN: Mapping[Measure, float] = {"head_height": 0.6}  # With the head lower than that, who stands or walks has fallen.

_STAND: Mapping[Measure, float] = {"upright": 0.8, "head_height": 0.85}
_ON_BELLY: Mapping[str, tuple[float, Shares]] = {"turn": (1.0, {"turned": (0.0, 1.0)})}
_ON_BACK: Mapping[str, tuple[float, Shares]] = {"turn": (1.0, {"turned": (1.0, 0.0)})}


def _sit_up(start: str) -> Skill:
    return Skill(
        8.0,
        {"upright": 0.7},
        {"upright": (0.7, {"upright": (0.0, 0.9)}), "height": (0.3, {"head_height": (0.15, 0.5)})},
        clear=("upper_body", "chest", *HEAD, *ARMS),
        kept_s=1.0,
        forward_axis=2,
        begin=lying(start),
    )


SKILLS: Mapping[str, Skill] = {
    "roll_supine": Skill(5.0, {"prone": ROLLED}, _ON_BELLY, kept_s=0.5, forward_axis=2, begin=lying("supine")),
    "roll_prone": Skill(5.0, {"supine": ROLLED}, _ON_BACK, kept_s=0.5, forward_axis=2, begin=lying("prone")),
    "sit_up_supine": _sit_up("supine"),
    "sit_up_prone": _sit_up("prone"),
    "sit": Skill(
        10.5,
        {"upright": 0.5},
        {"upright": (1.0, {"upright": (0.2, 0.95)})},
        clear=("upper_body", "chest", *HEAD),
        kept_s=10.0,
        fall={"upright": 0.2},
        begin=lying("sitting"),
    ),
    "crawl_belly": Skill(
        10.0,
        {"prone": 0.5},
        {"speed": (1.0, {"speed": (-0.15, 0.15), "facing": (0.0, 1.0), "in_posture": (0.0, 1.0)})},
        way_m=0.5,
        fall={"prone": -0.2},
        forward_axis=2,
        begin=lying("prone"),
    ),
    "crawl_hands_and_knees": Skill(
        10.0,
        {"prone": 0.5, "hip_height": 0.4},
        {
            "on_all_fours": (0.5, {"in_posture": (0.0, 1.0), "facing": (0.0, 1.0)}),
            "speed": (1.0, {"speed": (-0.2, 0.2), "facing": (0.0, 1.0), "in_posture": (0.0, 1.0)}),
            "height": (0.3, {"hip_height": (0.25, 0.5)}),
        },
        clear=(*TRUNK, *HEAD, *ARMS),
        way_m=0.5,
        fall={"prone": -0.2},
        forward_axis=2,
        begin=on_hands_and_knees,
    ),
    "pull_to_stand": Skill(
        8.0,
        _STAND,
        {"height": (1.0, {"head_height": (0.35, 0.95)}), **STANDING},
        clear=(*TRUNK, *HEAD, *LEGS),
        kept_s=1.0,
        begin=at_rail,
    ),
    "stand": Skill(6.0, _STAND, STANDING, clear=ALL_BUT_FEET, kept_s=5.0, fall=FALLEN, begin=lying("standing")),
    "cruise": Skill(
        10.0,
        _STAND,
        {**STANDING, "speed": (1.0, {"speed": (-0.15, 0.15), "upright": (0.2, 0.9), "facing": (0.5, 1.0)})},
        clear=(*TRUNK, *HEAD, *LEGS),
        way_m=0.3,
        fall=FALLEN,
        way="left",
        begin=at_table,
    ),
    "walk": Skill(
        6.0,
        _STAND,
        {**STANDING, "speed": (1.0, {"speed": (-0.3, 0.3), "upright": (0.2, 0.9), "facing": (0.5, 1.0)})},
        clear=ALL_BUT_FEET,
        way_m=0.5,
        fall=FALLEN,
        begin=lying("standing"),
    ),
    "grasp": Skill(
        4.5, {"near": -0.11}, {"held": (1.0, {"near": (-0.12, -0.03)})}, kept_s=4.0, fall={"near": -0.14}, begin=holding
    ),
}
"""By name of the task, or with what chooses among several."""
PUSH = 0.05  # Force of a push, as a share of the weight; for 0.2 s, it gives the whole infant 10 cm/s. An assumption.

OFFERED_S = 1.0  # How long somebody carries what is put into a hand.


def build(task: SkillSpec, tree: BodyTree) -> TaskSetup:
    """Return the setup of a skill.

    Raises:
        UnsupportedTaskError: If the infant lacks what it needs.
    """
    choice = next((getattr(task, key) for key in ("start", "style") if hasattr(task, key)), None)
    skill = SKILLS[f"{task.kind}_{choice}" if choice else task.kind]
    names = {body.name for body in tree.bodies}
    require(tree, task.kind, "head")
    begin = skill.begin(task, tree)
    weight_n = GRAVITY_M_S2 * tree.mass_kg
    head_m = standing_height(tree) + float(frames(tree, {})["head"][0][2])
    entry = SkillEntry(
        kind=task.kind,
        steps=task.steps or round(skill.duration_s / ms_to_s(STEP_MS)),
        hip=tree.bodies[0].name,
        chest="upper_body",
        head="head",
        hand=begin.hand,
        object=begin.object,
        standing_head_m=head_m,
        standing_hip_m=standing_height(tree),
        forward_axis=skill.forward_axis,
        way=skill.way,
        posture=_bounds(skill.posture),
        clear=tuple(name for name in skill.clear if name in names),
        kept_s=skill.kept_s,
        way_m=skill.way_m,
        reward=tuple(
            RewardEntry(name=name, weight=weight, shares=_shares(shares))
            for name, (weight, shares) in skill.reward.items()
        ),
        fall=_bounds(skill.fall),
        pushes=getattr(task, "pushes", 0),
        push_n=PUSH * weight_n,
        **_help(task, begin, weight_n),
    )
    return replace(begin.setup, entry=entry)


def _help(task: SkillSpec, begin: Start, weight_n: float) -> dict[str, Any]:
    """Return the keys of an entry that say what is pushed or carried: the chest, or at first what is in the hand."""
    if begin.object:
        thing_n = GRAVITY_M_S2 * sum(thing.mass_kg for thing in begin.setup.objects)
        return {"helped": begin.object, "support_n": (thing_n, thing_n), "support_s": OFFERED_S}
    is_helped = task.support or getattr(task, "pushes", 0)
    return {"helped": "upper_body", "support_n": (0.0, task.support * weight_n)} if is_helped else {}


def _bounds(least: Mapping[Measure, float]) -> tuple[BoundEntry, ...]:
    return tuple(BoundEntry(measure=name, least=value) for name, value in least.items())


def _shares(shares: Shares) -> tuple[ShareEntry, ...]:
    return tuple(ShareEntry(measure=name, zero=zero, full=full) for name, (zero, full) in shares.items())
