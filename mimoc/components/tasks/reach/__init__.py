"""Touch a ball that hangs within reach."""

from typing import Literal

from mimoc.schema.entries import Amount, Body, Lengths, Number, Numbers
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import BallEntry, GazeEntry, TaskEntry, TaskSpec


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


KIND = TaskKind(
    "reach", ReachSpec, ReachEntry, "mimoc.components.tasks.reach.build", "mimoc.components.tasks.reach.run"
)
