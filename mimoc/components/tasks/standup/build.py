"""The setup of standing up: an infant sits on the floor, its feet flat before it, and holds on to a rail.

The rail is a bar across two posts, as high as that of a crib. A hand closes around it, and the arm brings it there.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import Vec3, matrix_from_axis, quaternion_from_axis
from mimoc.base.geometry.solvers import root
from mimoc.body.kinematics import FloatArray, frames, length_m, pose
from mimoc.body.poses import CONTACT_DEPTH_M, standing_height
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import RAIL_RADIUS_M, Furniture, WorldGeom, WorldMaterial, rail_height
from mimoc.compiler.task_setup import Hold, Side, TaskSetup, joints_of, require
from mimoc.components.tasks.standup import StandupEntry
from mimoc.schema.task import TaskSpec

STEPS = 500  # Length of an episode in steps (MIMo).
BASE_IN_CHILDREN = 0.2 / 0.82
"""Height of the head that earns nothing, for one length of the child: at 18 months, 0.82 m long, 0.2 m (MIMo)."""
STANDING = 0.85  # Share of the height of its head, when all joints are straight, from which on an infant stands.

SIDES: tuple[Side, Side] = ("right", "left")
LEANING_BACK_DEG = 48.0  # Angle by which the pelvis leans back.
TURN = matrix_from_axis((0.0, 1.0, 0.0), -math.radians(LEANING_BACK_DEG))
"""World from hip of a seated infant, shape (3, 3)."""
CURVED_DEG: Mapping[str, float] = {"hip_bend1": 15.0, "hip_bend2": 15.0, "head_tilt": -10.0}
"""Curves the back, which brings the chest forward again, as far as its segments stay apart; the head looks ahead."""
HIPS_DEG = range(-88, -101, -1)
"""Angles of the hips, of which the first that flat feet allow is taken: the knees are drawn up, the further the less
the ankles bend down. Further than the last, the legs of the youngest would touch the trunk."""
STRETCHED = 0.96
"""How far it is from a shoulder to the rail, in lengths of the shorter arm: the infant can hang on to it."""
COMMANDED = ("trunk", "left_arm", "right_arm", "left_leg", "right_leg")
LOCKED = ("neck", "eyes", "left_hand", "right_hand")
"""Groups that neither stand up nor hold on, and would loll, and hands but for their wrists, which stay closed."""
WRIST = ("hand1", "hand2", "hand3")
_PRECISION_DEG = 1e-9

HALF_SPAN_IN_CHILDREN = 0.45
"""From the middle of the rail to a post, for one length of the child: as far as an arm reaches to the side."""
POST_RADIUS_M = 0.015
WOOD = WorldMaterial("rail_wood", (0.82, 0.66, 0.46, 1.0))
_ALONG_Y: Vec3 = (math.pi / 2, 0.0, 0.0)
_UPRIGHT: Vec3 = (0.0, 0.0, 0.0)

CLEAR_M = 0.001  # Between a bar and the hand around it: the hold carries the infant, not the contact.
KNUCKLES_DEG = 60.0  # How far the fingers are bent at the knuckles.
CURLED_DEG: Mapping[str, Mapping[str, float]] = {
    "mitten": {"fingers": -KNUCKLES_DEG},
    "five_finger": {
        **{f"{finger}_knuckle": KNUCKLES_DEG for finger in ("ff", "mf", "rf")},
        **{f"{finger}_middle": 30.0 for finger in ("ff", "mf", "rf", "lf")},
        **{f"{finger}_distal": 15.0 for finger in ("ff", "mf", "rf", "lf")},
        "lf_knuckle": 50.0,  # It begins nearer to the wrist.
        "th_swivel": -8.0,
    },
}
"""Fingers around a bar, by kind of hand and joint; a thumb stays beside the palm."""
KNUCKLES = {"mitten": "fingers", "five_finger": "mfknuckle"}  # The first body of the fingers.
STRETCHED_OUT_DEG: Mapping[str, float] = {
    "shoulder_horizontal": 80,
    "shoulder_ad_ab": 90,
    "shoulder_rotation": 0,
    "elbow": -30,
    "hand1": 0,
    "hand2": 0,
    "hand3": 0,
}
"""An arm that is stretched out forwards, as it would rather be: there the search for its angles begins."""
ROUNDS = 40
SHYNESS, FADING, MIN_SHYNESS = 0.1, 0.6, 1e-4
"""How much a radian away from there counts against a metre at first, what is left of that after each round, and at
last."""
THUMBS_INSIDE: Mapping[Side, Vec3] = {"right": (0.0, 1.0, 0.0), "left": (0.0, -1.0, 0.0)}
"""Where the x axes of hands point along a bar before the infant, to the side of their thumbs."""
TURN_M = 0.1  # What a hand that is turned the wrong way by one radian counts like.
STEP_RAD = 1e-6


def curled(tree: BodyTree, side: Side) -> dict[str, float]:
    """Return the angles of the fingers of a hand that is closed around a bar, in [rad].

    By the published law, little fingers begin half a palm nearer to the wrist, where the bar is, and stay open.
    """
    opened = ("lf_knuckle",) if tree.development == "published" else ()
    curled = {name: 0.0 if name in opened else angle for name, angle in CURLED_DEG[tree.hands].items()}
    return {f"robot:{side}_{name}": math.radians(angle) for name, angle in curled.items()}


def grip_point(tree: BodyTree, side: Side, radius_m: float) -> Vec3:
    """Return where the axis of a bar goes through a closed hand, in the hand's frame, in [m].

    The bar lies in the corner between palm and fingers, as far from the one as from the others; the hand's x axis is
    along the bar, to the side of the thumb.
    """
    palm = tree.geoms[f"{side}_hand1"]
    knuckles = next(body for body in tree.bodies if body.name == f"{side}_{KNUCKLES[tree.hands]}")
    away_m = radius_m + palm.size_m[1] + CLEAR_M
    inwards = -1.0 if side == "right" else 1.0
    before_m = away_m * math.tan(math.radians(KNUCKLES_DEG) / 2)
    return palm.pos_m[0], palm.pos_m[1] + inwards * away_m, knuckles.pos_m[2] - before_m


def arm_length(tree: BodyTree, side: Side, point_m: Vec3) -> float:
    """Return how far a point of the hand, in the hand's frame, is from the shoulder of a straight arm, in [m]."""
    straight = frames(tree, {})
    origin, turn = straight[f"{side}_hand"]
    return float(np.linalg.norm(origin + turn @ point_m - straight[f"{side}_upper_arm"][0]))


def arm_to_bar(
    tree: BodyTree, angles_rad: Mapping[str, float], side: Side, point_m: Vec3, place_m: FloatArray, along: FloatArray
) -> dict[str, float]:
    """Return the angles of an arm and its wrist that bring a point of the hand to a bar, in [rad].

    Args:
        tree: The body.
        angles_rad: Of its other joints.
        side: Of the hand.
        point_m: The point, in the hand's frame.
        place_m: Where it is to be, shape (3,), in the frame of the hip.
        along: Where the hand's x axis is to point, a unit vector, shape (3,), in the frame of the hip.

    Raises:
        UnsupportedTaskError: If the arm does not get there.
    """
    names = [f"robot:{side}_{name}" for name in STRETCHED_OUT_DEG]
    low, high = np.deg2rad([tree.joints[name].range_deg for name in names]).T
    wanted = np.clip(np.deg2rad(list(STRETCHED_OUT_DEG.values())), low, high)
    # The parts of a body from the hip to one of them.
    bodies = {body.name: body for body in tree.bodies}
    way = [bodies[f"{side}_hand"]]
    while parent := way[0].parent:
        way = [bodies[parent], *way]
    chain = replace(tree, bodies=tuple(way))

    def misses(angles: FloatArray) -> FloatArray:
        """Return how far the point is off, then how far the hand is turned off, shape (6,), [m]."""
        placed = frames(chain, {**angles_rad, **dict(zip(names, angles.tolist(), strict=True))})
        origin, turn = placed[f"{side}_hand"]
        return np.concatenate([origin + turn @ point_m - place_m, TURN_M * (turn[:, 0] - along)])

    nearest = _search(misses, wanted, low, high)
    if np.abs(misses(nearest)).max() > CLEAR_M:
        raise UnsupportedTaskError(f"it starts with the hands at a rail; the {side} hand does not reach it")
    return dict(zip(names, np.round(nearest, 6).tolist(), strict=True))


def _search(
    misses: Callable[[FloatArray], FloatArray], wanted: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Return angles between *low* and *high* with the least misses, near those that are *wanted*.

    Damped Newton steps (Levenberg 1944), at first drawn to what is wanted, later hardly so.
    """
    angles, shyness = wanted, SHYNESS
    steps = STEP_RAD * np.eye(len(wanted))
    for _ in range(ROUNDS):
        missed = misses(angles)
        slope = np.column_stack([(misses(angles + step) - missed) / STEP_RAD for step in steps])
        damped = slope.T @ slope + shyness**2 * np.eye(len(wanted))
        pull = slope.T @ missed + shyness**2 * (angles - wanted)
        angles = np.clip(angles - np.linalg.solve(damped, pull), low, high)
        shyness = max(FADING * shyness, MIN_SHYNESS)
    return angles


@dataclass(frozen=True, slots=True)
class Rail:
    """A rail along y, on the floor at z = 0."""

    x_m: float
    height_m: float  # Height of its middle.
    half_span_m: float  # Distance from its middle to a post.

    @property
    def furniture(self) -> Furniture:
        """The bar and its posts."""
        middle = (self.x_m, 0.0, self.height_m)
        size = (RAIL_RADIUS_M, self.half_span_m)
        bar = WorldGeom("rail", "capsule", size, middle, _ALONG_Y, WOOD.name)
        return Furniture((bar, self._post("left", 1.0), self._post("right", -1.0)), (WOOD,))

    @property
    def feet(self) -> tuple[Vec3, Vec3]:
        """What its posts take up of the floor: discs by x, y and radius, in [m]."""
        return (self.x_m, self.half_span_m, POST_RADIUS_M), (self.x_m, -self.half_span_m, POST_RADIUS_M)

    def _post(self, name: str, side: float) -> WorldGeom:
        middle = (self.x_m, side * self.half_span_m, self.height_m / 2)
        size = (POST_RADIUS_M, self.height_m / 2)
        return WorldGeom(f"rail_post_{name}", "cylinder", size, middle, _UPRIGHT, WOOD.name)


@dataclass(frozen=True)
class Seat:
    """How an infant sits: upright is along z, as in the world, with the hip at x = y = 0."""

    angles_rad: Mapping[str, float]
    height_m: float  # Height of the hip above the floor.

    def in_world(self, place_m: FloatArray) -> FloatArray:
        """Return a place in the frame of the hip, shape (3,), as one in the world."""
        return TURN @ place_m + (0.0, 0.0, self.height_m)

    def in_hip(self, place_m: FloatArray) -> FloatArray:
        """Return a place in the world, shape (3,), as one in the frame of the hip."""
        return TURN.T @ (place_m - (0.0, 0.0, self.height_m))


def build(task: TaskSpec, tree: BodyTree) -> TaskSetup:
    """Return the setup of `standup`, or of a task that begins in the same way, which errors name.

    Raises:
        UnsupportedTaskError: If the infant lacks fingers or a foot, or cannot sit with its feet on the floor and its
            hands at the rail.
    """
    require(
        tree, task.kind, *(f"{side}_{part}" for side in SIDES for part in (KNUCKLES.get(tree.hands, "fingers"), "foot"))
    )
    seat = _sit(tree, task.kind)
    grips: dict[Side, Vec3] = {side: grip_point(tree, side, RAIL_RADIUS_M) for side in SIDES}
    child_m = length_m(tree)
    standing_m = standing_height(tree) + float(frames(tree, {})["head"][0][2])
    # How far before the hip the rail is, in [m]: as far as the shorter arm gets to it.
    seated = frames(tree, seat.angles_rad)
    distances_m = list[float]()
    for side in SIDES:
        stretched_m = STRETCHED * arm_length(tree, side, grips[side])
        x_m, _, z_m = seat.in_world(seated[f"{side}_upper_arm"][0]).tolist()
        above_m = rail_height(tree) - z_m
        if stretched_m <= above_m:
            raise UnsupportedTaskError(
                f"task '{task.kind}' starts with the hands at a rail; this infant's arms are too short"
            )
        distances_m.append(x_m + math.sqrt(stretched_m**2 - above_m**2))
    rail = Rail(min(distances_m), rail_height(tree), HALF_SPAN_IN_CHILDREN * child_m)
    wrists = {f"robot:{side}_{name}" for side in SIDES for name in WRIST}
    return TaskSetup(
        entry=StandupEntry(
            steps=task.steps or STEPS, head="head", base_m=BASE_IN_CHILDREN * child_m, success_m=STANDING * standing_m
        ),
        start=_start(tree, seat, rail, grips),
        commanded=joints_of(tree, *COMMANDED),
        locked={*joints_of(tree, *LOCKED)} - wrists,
        holds=tuple(Hold(f"{side}_hand", grips[side], turns=True) for side in SIDES),
        furniture=rail.furniture,
        taken=rail.feet,
    )


def _sit(tree: BodyTree, task: str) -> Seat:
    """Return how an infant sits on the floor, its back curved, its knees drawn up and its feet flat on the floor."""
    for hip_deg in HIPS_DEG[:-1]:
        with suppress(UnsupportedTaskError):
            return _seat(tree, hip_deg, task)
    return _seat(tree, HIPS_DEG[-1], task)


def _seat(tree: BodyTree, hip_deg: float, task: str) -> Seat:
    angles = {f"robot:{name}": math.radians(angle) for name, angle in CURVED_DEG.items()}
    angles |= {f"robot:{side}_hip1": math.radians(hip_deg) for side in SIDES}
    for side in SIDES:
        angles |= curled(tree, side)
    height_m = _depth(tree, angles, ("hip", "left_upper_leg", "right_upper_leg"))
    for side in SIDES:
        angles |= _flat_foot(tree, angles, side, LEANING_BACK_DEG - hip_deg, height_m, task)
    return Seat(angles, height_m - CONTACT_DEPTH_M)


def _depth(tree: BodyTree, angles_rad: Mapping[str, float], parts: tuple[str, ...]) -> float:
    """Return how far below the hip some parts reach, in [m]."""
    extents_m = pose(tree, angles_rad).reaches(TURN.T @ (0.0, 0.0, -1.0))
    owners = [body.name for body in tree.bodies for _ in body.geoms]
    return max(extent for extent, owner in zip(extents_m.tolist(), owners, strict=True) if owner in parts)


def _flat_foot(
    tree: BodyTree, angles_rad: Mapping[str, float], side: Side, thigh_deg: float, height_m: float, task: str
) -> dict[str, float]:
    """Return knee and ankle, in [rad], that put a foot flat on the floor, which is so far below the hip.

    The thigh is turned up by *thigh_deg* from hanging down. With a flat foot the ankle follows from the knee; the
    farther the knee is bent, the steeper is the shank and the deeper the foot.
    """
    least_deg, most_deg = (-deg for deg in reversed(tree.joints[f"robot:{side}_knee"].range_deg))
    ankle_low_deg, _ = tree.joints[f"robot:{side}_foot1"].range_deg
    low = max(least_deg, thigh_deg + ankle_low_deg)
    high = min(most_deg, thigh_deg)

    def leg(knee_deg: float) -> dict[str, float]:
        knee = math.radians(-knee_deg)
        ankle = math.radians(knee_deg - thigh_deg)
        return {f"robot:{side}_knee": knee, f"robot:{side}_foot1": ankle}

    def too_deep_m(knee_deg: float) -> float:
        return _depth(tree, {**angles_rad, **leg(knee_deg)}, (f"{side}_foot",)) - height_m

    if too_deep_m(low) >= 0 and low > least_deg:
        raise UnsupportedTaskError(
            f"task '{task}' starts with flat feet; this infant's {side} ankle bends down by {-ankle_low_deg:.0f} deg, "
            "which is not enough (infants whose development is 'maturing' stand up from 3 months on)"
        )
    if not too_deep_m(low) < 0 < too_deep_m(high):
        raise UnsupportedTaskError(
            f"task '{task}' starts with flat feet; this infant's {side} leg has the wrong length"
        )
    knee_deg = root(too_deep_m, low, high, _PRECISION_DEG)
    return {name: round(angle, 6) for name, angle in leg(knee_deg).items()}


def _start(tree: BodyTree, seat: Seat, rail: Rail, grips: Mapping[Side, Vec3]) -> tuple[float, ...]:
    angles = dict(seat.angles_rad)
    seated = frames(tree, angles)
    for side in SIDES:
        shoulder_y_m = float(seated[f"{side}_upper_arm"][0][1])
        place_m = seat.in_hip(np.array([rail.x_m, shoulder_y_m, rail.height_m]))
        angles |= arm_to_bar(tree, seat.angles_rad, side, grips[side], place_m, np.array(THUMBS_INSIDE[side]))
    hinges = (angles.get(joint, 0.0) for joint in tree.joints)
    return (0.0, 0.0, seat.height_m, *quaternion_from_axis((0.0, 1.0, 0.0), -math.radians(LEANING_BACK_DEG)), *hinges)
