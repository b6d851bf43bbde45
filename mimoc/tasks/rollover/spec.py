"""What can be asked of the task `rollover`, and what the runtime must know of it."""

from typing import Literal

from mimoc.tasks.base import TaskEntry, TaskSpec


class RolloverSpec(TaskSpec):
    """Turn over, from the back to the belly or the other way."""

    kind: Literal["rollover"]
    """Which task this is."""
    reward: Literal["dense", "shaped"] | None = None
    """For how far the infant has turned, at every step (`dense`, if left out), or for success, shaped by how much
    farther it has turned in each step."""


class RolloverEntry(TaskEntry):
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
