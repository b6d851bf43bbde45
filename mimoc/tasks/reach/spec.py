"""What can be asked of the task `reach`, and what the runtime must know of it."""

from typing import Literal

from mimoc.tasks.base import BallEntry, GazeEntry, Range, TaskEntry, TaskSpec


class ReachSpec(TaskSpec):
    """Touch a ball that hangs within reach."""

    kind: Literal["reach"]
    """Which task this is."""
    hand: Literal["right", "left"] | None = None
    """The hand that reaches; left out, the right one."""


class ReachEntry(TaskEntry):
    """Touch a ball that hangs before the infant."""

    kind: Literal["reach"] = "reach"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    effector: str
    """The body that is to come near the ball."""
    shoulder: str
    """The body that the ball's places are seen from."""
    trunk: str
    """The body whose x axis is forward and whose z axis is up."""
    ball: BallEntry
    """What is to be touched."""
    distance_m: Range
    """From the shoulder to the ball."""
    azimuth_rad: Range
    """Of the ball, to the left of forward."""
    elevation_rad: Range
    """Of the ball, above forward."""
    moved_m: float = 0.01
    """How far the ball is moved by a touch that counts (MIMo)."""
    success_reward: float = 100.0
    """For touching it (MIMo)."""
    gaze: tuple[GazeEntry, ...]
    """What keeps looking at the ball, in the order in which it turns."""
