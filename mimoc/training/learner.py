"""What learns in a training, between its checkpoints."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from stable_baselines3.common.logger import Logger

from mimoc.training.checkpoint import Progress
from mimoc.training.curve import CurvePoint


@dataclass(frozen=True, slots=True)
class DeviceUse:
    """What a training has taken of a device."""

    device: str
    control_steps_per_s: float
    """Control steps of all infants together, learning included."""
    physics_steps_per_s: float
    """Likewise."""
    memory_mb: float | None
    """Most memory that PyTorch and Warp had on it; None on the CPU."""
    overflowed: int
    """Episodes that were cut because contacts or constraints of the infant did not fit."""
    success: float
    """Share of the infants that have success in an episode in which the trained policy explores nothing."""


class Learner(Protocol):
    """An agent and its environments, which learn from one checkpoint to the next."""

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        ...

    async def learn(
        self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]
    ) -> None:
        """Learn until the next checkpoint; *report* gets the steps so far, *on_row* each new row of the curve."""

    def progress(self) -> Progress:
        """Return the progress at the end of what was learnt last, or where that was interrupted."""
        ...

    @property
    def has_learnt(self) -> bool:
        """Whether it was updated since it was made or restored."""
        ...

    def policy(self) -> bytes:
        """Return the content of the file of its policy."""
        ...

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint file."""
        ...

    async def use(self) -> DeviceUse | None:
        """Return what was taken of a device, and what the policy does there; None on the CPU."""
        ...
