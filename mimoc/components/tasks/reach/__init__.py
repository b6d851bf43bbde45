"""Touch a ball that hangs within reach."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from mimoc.base.geometry.rotations import direction
from mimoc.schema.entries import Amount, Body, Lengths, Number, Numbers
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import BallEntry, GazeEntry, TaskEntry, TaskSpec

if TYPE_CHECKING:
    from collections.abc import Callable

    from mimoc.base.geometry.rotations import FloatArray
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.task_setup import Side, TaskSetup


class ReachSpec(TaskSpec):
    """Touch a ball that hangs within reach."""

    kind: Literal["reach"]
    """Name of the task."""
    hand: Literal["left", "right"] | None = None
    """The hand that reaches; by default, the right one."""
    goal: Literal["touch", "hold"] = "touch"
    """Touch the ball, which chance does sooner or later; or keep the fingers at it for half a second (`hold`)."""
    ball: Literal["near", "mimo"] = "near"
    """Where the ball hangs: `near`, .65 to .95 lengths of the arm away, or `mimo`, as in MIMo's scene, .87 to 1.48."""


class ReachEntry(TaskEntry):
    """Touch a ball that hangs in front of the infant."""

    kind: Literal["reach"] = "reach"
    """Name of the task."""
    effector: Body
    """The body whose distance to the ball is rewarded."""
    shoulder: Body
    """The body at the origin of the ball's spherical coordinates."""
    trunk: Body
    """The body whose x axis is forward and whose z axis is up."""
    ball: BallEntry
    """The ball."""
    distance_m: Lengths
    """Range of the distance from the shoulder to the ball."""
    azimuth_rad: Numbers
    """Range of the ball's azimuth; left of forward is positive."""
    elevation_rad: Numbers
    """Range of the ball's elevation; above forward is positive."""
    box_m: tuple[Numbers, Numbers, Numbers] | None = None
    """Ranges of the ball's place from the shoulder along the axes of the trunk, in place of these, if given."""
    moved_m: Amount = 0.01
    """Distance that the ball must be moved for a touch to count (MIMo)."""
    success_reward: Number = 100.0
    """Reward for touching the ball (MIMo), or for having held the fingers at it."""
    hold_s: Amount = 0.0
    """How long the fingers must be near the ball at a stretch, in [s]; 0 if a touch is enough."""
    near_m: Amount = 0.0
    """Distance of the fingers' joint to the middle of the ball that counts as near, in [m]."""
    gaze: tuple[GazeEntry, ...]
    """Joints that keep the head and the eyes on the ball, in the order in which they turn."""


STEPS = 1000  # Length of an episode in steps (MIMo).
NEAREST, FARTHEST = 0.65, 0.95  # Distances of the ball from the shoulder, in arm lengths (shoulder to fingers).
OUTWARD_DEG, INWARD_DEG = 45.0, 30.0
"""How far the ball is to the side of the shoulder: to that of the hand, and to the other."""
ELEVATION_DEG = (-45.0, 25.0)
MIMO_BOX = (0.868, 1.292), (-0.614, 0.657), (-0.042, 0.381)
"""Where the ball can be from the right shoulder in MIMo, in lengths of its arm (.236 m): ahead, to the left, above.

Its ball hangs at .2 to .3, -.25 to .05 and .6 to .7 m, its shoulder at -.005, -.105 and .61 m."""
HOLD_S, NEAR_IN_ARMS = 0.5, 0.25
"""How long fingers are held at a ball that is to be held, and how near, by the length of the arm: at nine months 5 cm,
a ball's radius and half a hand. Assumptions, with which random commands hold none of a hundred balls."""


def build(task: ReachSpec, tree: "BodyTree") -> "TaskSetup":
    """Return the setup of `reach`.

    Raises:
        UnsupportedTaskError: If the infant has no such hand.
    """
    from mimoc.body.kinematics import frames, frames_in_world
    from mimoc.body.poses import poses_of, resting_state
    from mimoc.compiler.task_setup import BALL, ball, joints_of, middle_finger, one_armed, require

    side: Side = task.hand or "right"
    effector = middle_finger(tree, side)
    require(tree, task.kind, effector)
    # How an infant stands whose arm floats, as its springs have it: there is no gravity.
    standing = poses_of(tree)["standing"]
    arm = joints_of(tree, f"{side}_arm", f"{side}_hand")
    slack = {joint.removeprefix("robot:"): tree.joints[joint].springref_deg for joint in arm}
    start = resting_state(tree, replace(standing, angles_deg={**standing.angles_deg, **slack}))
    stretched = frames(tree, {})
    arm_m = float(np.linalg.norm(stretched[effector][0] - stretched[f"{side}_upper_arm"][0]))
    outward, inward = math.radians(OUTWARD_DEG), math.radians(INWARD_DEG)
    turns = [("robot:head_swivel", "head"), ("robot:head_tilt", "head")]
    turns += [(f"robot:{eye}_{way}", eye) for eye in ("left_eye", "right_eye") for way in ("horizontal", "vertical")]
    entry = ReachEntry(
        steps=task.steps or STEPS,
        effector=effector,
        shoulder=f"{side}_upper_arm",
        trunk=tree.home("chest"),
        ball=BALL,
        distance_m=(NEAREST * arm_m, FARTHEST * arm_m),
        azimuth_rad=(-outward, inward) if side == "right" else (-inward, outward),
        elevation_rad=(math.radians(ELEVATION_DEG[0]), math.radians(ELEVATION_DEG[1])),
        box_m=_mimo_box(arm_m, side) if task.ball == "mimo" else None,
        gaze=tuple(GazeEntry(joint=joint, looker=looker) for joint, looker in turns if joint in tree.joints),
        hold_s=HOLD_S if task.goal == "hold" else 0.0,
        near_m=NEAR_IN_ARMS * arm_m if task.goal == "hold" else 0.0,
    )
    placed = frames_in_world(tree, start)
    shoulder_m, trunk_axes = placed[entry.shoulder][0], placed[entry.trunk][1]
    x, y, z = (shoulder_m + trunk_axes @ ball_from_shoulder(entry, lambda ends: sum(ends) / 2)).tolist()
    return one_armed(tree, side, entry, start, (ball((x, y, z)),), weightless=True)


def _mimo_box(arm_m: float, side: "Side") -> tuple[Numbers, Numbers, Numbers]:
    """Return MIMo's box by the size of an arm, mirrored for the left one, in [m]."""
    ahead, (right, left), above = ((arm_m * low, arm_m * high) for low, high in MIMO_BOX)
    return ahead, (right, left) if side == "right" else (-left, -right), above


def ball_from_shoulder(entry: ReachEntry, pick: "Callable[[tuple[float, float]], float]") -> "FloatArray":
    """Return where the ball hangs from the shoulder, along the axes of the trunk, shape (3,), [m].

    *pick* returns a number of a range of the entry, such as its middle or one that is drawn.
    """
    if entry.box_m:
        return np.array([pick(ends) for ends in entry.box_m])
    distance_m, azimuth, elevation = map(pick, (entry.distance_m, entry.azimuth_rad, entry.elevation_rad))
    return distance_m * direction(azimuth, elevation)


KIND = TaskKind("reach", ReachSpec, ReachEntry, build, "mimoc.components.tasks.reach.run")
