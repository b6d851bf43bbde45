"""Which learner a training has, and what is refused on a device."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any

from mimoc.base.errors import TrainingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.world import WorldBundle
from mimoc.runtime.env import InfantEnv
from mimoc.training.learner import Learner
from mimoc.training.sb3_learner import sb3_learner
from mimoc.training.settings import CPU, TrainingSettings
from mimoc.training.vector_env import growth_of, infants_together, normalized, worlds_together

LearnerOpener = Callable[[], AbstractContextManager[Learner]]
"""Opens parallel environments, and what learns from them."""


def choose_learner(
    settings: TrainingSettings,
    infant: InfantEnv,
    bundle: Bundle | WorldBundle,
    open_one: Callable[..., Any],
    threads: int | None,
    processes: bool | None,
    record: str | Path | None,
) -> LearnerOpener:
    """Return what opens the parallel environments of a training, and what learns from them; see `train`.

    Raises:
        DeviceError: If the infant cannot live on the device.
        MimocError: If it sees images there, or cannot grow between the ages of the training.
    """
    if settings.device != CPU:
        from mimoc.training.device_learner import check_on_device, device_learner

        check_on_device(settings.device, infant)
        return partial(device_learner, settings, infant, open_one)
    growth = growth_of(bundle, settings)
    if isinstance(bundle, WorldBundle):
        open_rows: Any = partial(worlds_together, open_one, settings, len(bundle.infants), growth, threads)
    else:
        open_rows = partial(infants_together, open_one, settings, growth, threads, processes)
    open_envs = partial(normalized, open_rows, settings)
    return partial(sb3_learner, settings, infant, open_envs, record)


ONLY_ON_CPU = {
    "grow": "infants do not grow in a training on a device; leave out --grow, or --device",
    "record": "a training on a device is not recorded; leave out --record, or --device",
    "threads": "threads are for infants on the CPU; leave out --threads, or --device",
    "processes": "processes are for infants on the CPU; leave out --processes and --one-process, or --device",
}


def refuse_in_world(device: str, processes: bool | None) -> None:
    """Check that nothing is asked for that worlds of several infants cannot have in a training.

    Raises:
        TrainingError: If something is.
    """
    if device != CPU:
        raise TrainingError("worlds with several infants are simulated on the CPU; leave out --device")
    if processes is not None:
        raise TrainingError("worlds of a training are in one process; leave out --processes and --one-process")


def refuse_on_device(device: str, **options: Any) -> None:
    """Check that a device is there, and that nothing is asked for that cannot be on one.

    Raises:
        TrainingError: If something is.
        DeviceError: If there is no such device.
        MissingExtraError: If MuJoCo Warp or rsl_rl is not installed.
    """
    if device == CPU:
        return
    for name, value in options.items():
        if value is not None:
            raise TrainingError(ONLY_ON_CPU[name])
    from mimoc.runtime.device.signals import find_device
    from mimoc.training import rsl_rl_env  # noqa: F401 - It says if rsl_rl is missing.

    find_device(device.removeprefix("warp:"))
