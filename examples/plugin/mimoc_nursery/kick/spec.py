"""What can be asked of the task `kick`, and what the runtime must know of it."""

from typing import Literal

from mimoc.schema.task import TaskEntry, TaskSpec


class KickSpec(TaskSpec):
    """Move a mobile that hangs above and is tied to one foot by a ribbon; the more it moves, the larger the reward."""

    kind: Literal["kick"]
    """Which task this is."""
    foot: Literal["right", "left"] = "right"
    """The foot that the ribbon is tied to."""


class KickEntry(TaskEntry):
    """Move a mobile that is tied to a foot."""

    kind: Literal["kick"] = "kick"
    """Which task this is."""
    foot: str
    """Body that the ribbon is tied to."""
    mobile: str
    """Body of the mobile."""
    frequency_hz: float = 1.0
    """Of the mobile when it swings freely."""
    damping_ratio: float = 0.1
    """Of the mobile's swing."""
    ribbon_n_per_m: float = 20.0
    """Stiffness of the ribbon, which only pulls."""
    success_m: float = 2.0
    """Length of the path that the mobile must travel in an episode to count as a success."""
