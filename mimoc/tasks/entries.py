"""What the runtime must know of a task: the parts of the manifest that judge what an infant does."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model

Range = tuple[float, float]


class BallEntry(Model):
    """A ball that a task is about."""

    body: str
    """Its body in the model."""
    joint: str
    """Its free joint."""
    geom: str
    """Its one geom, a sphere."""


class GazeEntry(Model):
    """A joint of the head or an eye that turns to what is looked at."""

    joint: str
    """The hinge, which is locked at the angle that looks there."""
    looker: str
    """The body whose x axis is to point there."""


class FreeEntry(Model):
    """No goal at all."""

    kind: Literal["free"] = "free"
    """Which task this is."""
    steps: int | None = None
    """Control steps of an episode; None is no end."""


class ReachEntry(Model):
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


class StandupEntry(Model):
    """Stand up, holding on to a rail."""

    kind: Literal["standup"] = "standup"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    head: str
    """The body that is to get up high."""
    base_m: float
    """Height of the head that earns nothing."""
    success_m: float
    """Height of the head of an infant that stands."""
    effort_weight: float = 0.01
    """What the sum of squared actions costs (MIMo)."""


class TargetEntry(Model):
    """A part of the body that is to be touched."""

    name: str
    """What it is called in the goal."""
    bodies: tuple[str, ...]
    """What belongs to it."""


class SelfbodyEntry(Model):
    """Touch a part of oneself."""

    kind: Literal["selfbody"] = "selfbody"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    fingers: str
    """The body whose distance to what is to be touched counts."""
    effectors: tuple[str, ...]
    """The bodies that touch."""
    targets: tuple[TargetEntry, ...]
    """What is to be touched, one of them in each episode; the observation `goal` has a number for each."""
    success_reward: float = 500.0
    """For touching it (MIMo)."""
    idle_reward: float = -1.0
    """For a step in which nothing is touched (MIMo)."""


class CatchEntry(Model):
    """Catch a ball that falls on the open hand."""

    kind: Literal["catch"] = "catch"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    hand: tuple[str, ...]
    """The bodies that catch."""
    palm: str
    """The body over which the ball is dropped."""
    palm_m: tuple[float, float, float]
    """The point of it that the ball falls on, in its frame."""
    ball: BallEntry
    """What is to be caught."""
    radius_m: Range = (0.005, 0.025)
    """Of the ball, drawn for each episode (MIMo)."""
    mass_kg: Range = (0.05, 0.5)
    """Of the ball, drawn for each episode (MIMo)."""
    drop_m: Range
    """Height of the ball over the palm, drawn for each episode."""
    lost_m: float
    """How far below the palm or to its side the ball is lost."""
    held_steps: int = 100
    """Control steps of contact without a break that make a catch (MIMo)."""
    contact_reward: float = 1.0
    """For a step in contact (MIMo)."""
    effort_weight: float = 40.0
    """What effort costs (MIMo)."""
    success_reward: float = 100.0
    """For a catch, and what is lost with the ball (MIMo)."""


class RolloverEntry(Model):
    """Turn over: from the back to the belly, or from the belly to the back."""

    kind: Literal["rollover"] = "rollover"
    """Which task this is."""
    steps: int | None
    """Control steps of an episode; None is no end."""
    settle_steps: int = 100
    """Control steps at rest before an episode begins (MIMo)."""
    hip: str
    """The body that is to turn; its x axis points out of the belly."""
    goal: float = 0.8
    """How far is far enough: 0 is flat on the side that it starts on, 1 flat on the other (MIMo)."""
    reward: Literal["dense", "shaped"]
    """For how far it has turned, or for success, shaped by how much farther it has turned."""
    effort_weight: float = 0.01
    """What the sum of squared actions costs, where the reward is dense (MIMo)."""
    success_reward: float = 10.0
    """For turning over, where the reward is shaped."""
    discount: float = 0.99
    """Of the potential that shapes the reward; that of the learner, for the best policy to stay the best."""


GoalEntry = Annotated[
    FreeEntry | ReachEntry | StandupEntry | SelfbodyEntry | CatchEntry | RolloverEntry, Field(discriminator="kind")
]
"""What the runtime must know of a task, by kind."""
