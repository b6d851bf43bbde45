"""What a training needs of whatever learns: Stable-Baselines3's agents on the CPU, or rsl_rl's on a device."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Protocol

from mimoc.training.checkpoint import Progress
from mimoc.training.curve import CurvePoint

Report = Callable[[int], None]
"""Called with the control steps taken so far."""
OnRow = Callable[[CurvePoint], None]
"""Called with each new row of the learning curve."""


class Interval(Protocol):
    """Learning from one checkpoint to the next."""

    def learn(self, until: int) -> None:
        """Learn until so many control steps were taken, in whole rollouts."""

    def progress(self) -> Progress:
        """Return the progress at the end, or where it was interrupted."""
        ...


class Learner(Protocol):
    """Something that learns, with its environments."""

    infants: Any
    """Environments that a recording can follow; None if none can."""

    def restore(self, checkpoint: bytes) -> Progress:
        """Go on from a checkpoint; raise a TrainingError if it is damaged or of another learner."""
        ...

    def interval(self, before: Progress, report: Report, on_row: OnRow) -> Interval:
        """Begin an interval: environments are reset, with a seed of the interval's own."""
        ...

    def has_learnt(self) -> bool:
        """Return whether anything was learnt since it was made or restored."""
        ...

    def policy(self) -> bytes:
        """Return the content of the policy's file."""
        ...

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint."""
        ...

    def tracked(self, folder: Path) -> AbstractContextManager[None]:
        """Tell trackers of what is learnt within the context."""
        ...

    def speed(self) -> str:
        """Return what there is to say of how fast it learns and on what, in one line; empty if nothing is."""
        ...

    def close(self) -> None:
        """Close the environments."""
