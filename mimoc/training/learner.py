"""What learns in a training, between its checkpoints."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from stable_baselines3.common.logger import Logger

from mimoc.base.errors import TrainingError
from mimoc.runtime.env import InfantEnv
from mimoc.training.checkpoint import Progress
from mimoc.training.curve import CurvePoint
from mimoc.training.settings import TrainingSettings


@dataclass(frozen=True, slots=True)
class DeviceUse:
    """What a training has taken of a device."""

    device: str
    """Its name, as in `NVIDIA H100 (cuda:0)`."""
    control_steps_per_s: float
    """Control steps of all infants together, learning included."""
    physics_steps_per_s: float
    """Likewise."""
    memory_mb: float | None
    """Most memory that PyTorch and Warp had on it; None on the CPU."""
    overflowed: int
    """Episodes that were cut because contacts or constraints of the infant did not fit."""


class Learner(Protocol):
    """An agent and its environments, which learn from one checkpoint to the next."""

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        ...

    def learn(self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]) -> None:
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

    def use(self) -> DeviceUse | None:
        """Return what was taken of a device; None on the CPU."""
        ...


ONLY_ON_CPU = {
    "grow": "infants do not grow in a training on a device; leave out --grow, or --device",
    "record": "a training on a device is not recorded; leave out --record, or --device",
    "threads": "threads are for infants on the CPU; leave out --threads, or --device",
    "processes": "processes are for infants on the CPU; leave out --processes and --one-process, or --device",
}


def refuse_on_device(device: str, **options: Any) -> None:
    """Check that a device is there, and that nothing is asked for that cannot be on one.

    Raises:
        TrainingError: If something is.
        DeviceError: If there is no such device.
        MissingExtraError: If MuJoCo Warp or rsl_rl is not installed.
    """
    for name, reason in ONLY_ON_CPU.items():
        if options[name] is not None:
            raise TrainingError(reason)
    from mimoc.runtime.device.signals import find_device
    from mimoc.training import rsl_rl_env  # noqa: F401 - It says if rsl_rl is missing.

    find_device(device.removeprefix("warp:"))


def device_learner(
    settings: TrainingSettings, infant: InfantEnv, open_one: Callable[..., InfantEnv]
) -> Callable[[], AbstractContextManager[Learner]]:
    """Return what opens infants on a device with what learns from them, after a check that this infant can live there.

    Raises:
        DeviceError: If it cannot.
        MimocError: If it sees images.
    """
    from mimoc.training.device_learner import check_on_device, device_learner

    check_on_device(settings.device, infant)
    return partial(device_learner, settings, infant, open_one)
