"""The setup of reaching: a ball hangs before an infant that is held upright and looks at it."""

import math
from dataclasses import replace

import numpy as np

from mimoc.base.geometry.rotations import direction
from mimoc.body.kinematics import frames, frames_in_world
from mimoc.body.poses import poses_of, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.task_setup import BALL, Side, TaskSetup, ball, joints_of, middle_finger, one_armed, require
from mimoc.components.tasks.reach import ReachEntry, ReachSpec
from mimoc.schema.entries import Numbers
from mimoc.schema.task import GazeEntry

STEPS = 1000  # Of an episode (MIMo).
NEAREST, FARTHEST = 0.65, 0.95  # Of the places of the ball, in lengths of the arm from shoulder to fingers.
OUTWARD_DEG, INWARD_DEG = 45.0, 30.0
"""How far the ball is to the side of the shoulder: to that of the hand, and to the other."""
ELEVATION_DEG = (-45.0, 25.0)
MIMO_BOX = (0.868, 1.292), (-0.614, 0.657), (-0.042, 0.381)
"""Of the places of the ball from the right shoulder in MIMo, in lengths of its arm (.236 m): ahead, to the left, above.

Its ball hangs at .2 to .3, -.25 to .05 and .6 to .7 m, its shoulder at -.005, -.105 and .61 m."""
LOOKERS = ("left_eye", "right_eye")


HOLD_S, NEAR_IN_ARMS = 0.5, 0.25
"""How long fingers are held at a ball that is to be held, and how near, by the length of the arm: at nine months 5 cm,
a ball's radius and half a hand. Assumptions, with which random commands hold none of a hundred balls."""


def build(task: ReachSpec, tree: BodyTree) -> TaskSetup:
    """Return the setup of `reach`.

    Raises:
        UnsupportedTaskError: If the infant has no such hand.
    """
    side: Side = task.hand or "right"
    effector = middle_finger(tree, side)
    require(tree, task.kind, effector)
    # How an infant stands whose arm floats, as its springs have it: there is no gravity.
    standing = poses_of(tree)["standing"]
    arm = joints_of(tree, f"{side}_arm", f"{side}_hand")
    slack = {joint.removeprefix("robot:"): tree.joints[joint].springref_deg for joint in arm}
    start = resting_state(tree, replace(standing, angles_deg={**standing.angles_deg, **slack}))
    stretched = frames(tree, {})
    arm_m = float(np.linalg.norm(stretched[middle_finger(tree, side)][0] - stretched[f"{side}_upper_arm"][0]))
    outward, inward = math.radians(OUTWARD_DEG), math.radians(INWARD_DEG)
    # What looks at the ball: the head, then each eye that there is.
    turns = [("robot:head_swivel", "head"), ("robot:head_tilt", "head")]
    turns += [(f"robot:{eye}_{way}", eye) for eye in LOOKERS for way in ("horizontal", "vertical")]
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
    # The middle of the ball's places.
    placed = frames_in_world(tree, start)
    origin, (_, trunk) = placed[entry.shoulder][0], placed[entry.trunk]
    ranges = entry.box_m or (entry.distance_m, entry.azimuth_rad, entry.elevation_rad)
    first, second, third = (sum(ends) / 2 for ends in ranges)
    away_m = np.array([first, second, third]) if entry.box_m else first * direction(second, third)
    x, y, z = (origin + trunk @ away_m).tolist()
    return one_armed(tree, side, entry, start, (ball((x, y, z)),), weightless=True)


def _mimo_box(arm_m: float, side: Side) -> tuple[Numbers, Numbers, Numbers]:
    """Return MIMo's box by the size of an arm, mirrored for the left one, in [m]."""
    ahead, (right, left), above = ((arm_m * low, arm_m * high) for low, high in MIMO_BOX)
    return ahead, (right, left) if side == "right" else (-left, -right), above
