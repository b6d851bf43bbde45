"""Catch a ball that falls on the open hand."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

from mimoc.schema.entries import Amount, Body, Length, Lengths, Number, Steps
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import BallEntry, TaskEntry, TaskSpec

if TYPE_CHECKING:
    from mimoc.base.geometry.rotations import Vec3
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.task_setup import Side, TaskSetup


class CatchSpec(TaskSpec):
    """Catch a ball that falls onto the open hand."""

    kind: Literal["catch"]
    """Name of the task."""
    hand: Literal["left", "right"] | None = None
    """The hand that catches; by default, the right one."""


class CatchEntry(TaskEntry):
    """Catch a ball that falls onto the open hand."""

    kind: Literal["catch"] = "catch"
    """Name of the task."""
    hand: tuple[Body, ...]
    """Bodies of the hand that catches."""
    palm: Body
    """The body over which the ball is dropped."""
    palm_m: tuple[Number, Number, Number]
    """The point that the ball falls onto, in the frame of that body."""
    ball: BallEntry
    """The ball."""
    radius_m: Lengths = (0.005, 0.025)
    """Range of the ball's radius, drawn for each episode (MIMo)."""
    mass_kg: tuple[Length, Length] = (0.05, 0.5)
    """Range of the ball's mass, drawn for each episode (MIMo)."""
    drop_m: Lengths
    """Range of the ball's initial height over the palm, drawn for each episode."""
    lost_m: Amount
    """Distance below the palm or to its side beyond which the ball counts as lost."""
    held_steps: Steps = 100
    """Consecutive control steps of contact that count as a catch; 1 s (MIMo)."""
    contact_reward: Number = 1.0
    """Reward for a step in contact (MIMo)."""
    effort_weight: Number = 40.0
    """Weight of the cost of effort (MIMo)."""
    success_reward: Number = 100.0
    """Reward for a catch; losing the ball costs as much (MIMo)."""


STEPS = 800  # Length of an episode in steps (MIMo).
OFFERING = {
    "shoulder_ad_ab": -11.0,
    "shoulder_rotation": -16.0,
    "elbow": -97.0,
    "hand1": -90.0,
    "fingers": -35.0,
    **{f"{finger}_{joint}": 25.0 for finger in ("ff", "mf", "rf", "lf") for joint in ("knuckle", "middle")},
}
"""Angles of the arm that catches, in degrees: upper arm beside the body, which no forearm touches, palm as level as the
wrist turns it, because balls roll, fingers a little curled."""
SITTING = {
    "{side}_hip1": -95.0,
    "{side}_hip2": -33.0,
    "{side}_knee": -25.0,
    "{side}_shoulder_ad_ab": 30.0,
    "{side}_elbow": -45.0,
    "{side}_fingers": -40.0,
    "hip_bend1": 8.0,
    "hip_bend2": 8.0,
}
"""The trunk leans forward by 4 to 7 degrees, so that the forearm is level; all but the arm that catches is locked."""
LOOKING = {"head_tilt": 10.0}  # Looks down, but not so far that the ball would fall on a newborn's head.
ALONG_PALM = 0.4
"""Distance from the middle of the palm, towards the fingers, to where the ball falls, in halves of the palm."""
PALMAR: "Mapping[Side, float]" = {"right": -1.0, "left": 1.0}  # Where the palm looks along the y axis of its hand.
LOWEST, HIGHEST = 1.0, 2.0
"""Range of heights above the palm that the ball falls from, in lengths of the hand: at 18 months, 10 to 20 cm."""
LOST = 0.75  # How far from the palm the ball is lost, in lengths of the hand: farther than its fingers reach.


def build(task: CatchSpec, tree: "BodyTree") -> "TaskSetup":
    """Return the setup of `catch`.

    Raises:
        UnsupportedTaskError: If the infant has no such hand.
    """
    from mimoc.body.kinematics import frames, frames_in_world, pose
    from mimoc.body.poses import Pose, resting_state
    from mimoc.compiler.task_setup import BALL, RADIUS_M, ball, bodies_of, middle_finger, one_armed, require

    side: Side = task.hand or "right"
    require(tree, task.kind, f"{side}_hand", middle_finger(tree, side))
    # The pose of an infant that sits and offers a palm.
    arm = {f"{side}_{joint}": angle_deg for joint, angle_deg in OFFERING.items()}
    start = resting_state(tree, Pose(0, {**SITTING, **LOOKING, **arm}, relaxed=False))
    # How long a hand is that is stretched, in [m].
    stretched = pose(tree, {})
    names = {geom.name for body in tree.bodies if body.name in bodies_of(tree, f"{side}_hand") for geom in body.geoms}
    kept = [index for index, geom in enumerate(stretched.geoms) if geom.name in names]
    hand = stretched.only(kept)
    along = frames(tree, {})[f"{side}_hand"][1][:, 2]
    hand_m = hand.extent(along) + hand.extent(-along)
    entry = CatchEntry(
        steps=task.steps or STEPS,
        hand=bodies_of(tree, f"{side}_hand"),
        palm=f"{side}_hand",
        palm_m=_palm(tree, side),
        ball=BALL,
        drop_m=(LOWEST * hand_m, HIGHEST * hand_m),
        lost_m=LOST * hand_m,
    )
    # Where the ball hangs that falls from the middle of its heights.
    origin, rotation = frames_in_world(tree, start)[entry.palm]
    x, y, z = (origin + rotation @ entry.palm_m).tolist()
    return one_armed(tree, side, entry, start, (ball((x, y, z + sum(entry.drop_m) / 2 + RADIUS_M)),))


def _palm(tree: "BodyTree", side: "Side") -> "Vec3":
    """Return the point of the palm that the ball falls on, in the frame of the hand."""
    geom = tree.geoms[f"{side}_hand1"]
    _, half_thickness_m, half_length_m = geom.size_m
    _, y, z = geom.pos_m
    return 0.0, y + PALMAR[side] * half_thickness_m, z + ALONG_PALM * half_length_m


KIND = TaskKind(
    "catch", CatchSpec, CatchEntry, build, "mimoc.components.tasks.catch.run", scenes=("flat", "crib", "room")
)
