"""Training of an infant that grows."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from stable_baselines3.common.vec_env import VecNormalize

from mimoc.bundle.io import Bundle
from mimoc.compiler.variants import BundleVariants
from mimoc.errors import TrainingError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing_env import Growing
from mimoc.runtime.growth_schedule import growth_schedule, read_ages
from mimoc.training.settings import Settings


def growth_settings(grow: str | None, schedule: str, grow_steps: int | None, steps: int) -> dict[str, Any]:
    """Return the settings of growth: none without a range of ages.

    Args:
        grow: The youngest and the oldest age in months, such as `6:12`; None if the infant does not grow.
        schedule: In which order it has these ages.
        grow_steps: Control steps that growth takes, summed over all environments; None is the whole training.
        steps: Control steps of the training.

    Raises:
        MimocError: If this is no range of ages, no schedule, or no number of steps.
    """
    if grow is None:
        if grow_steps is not None:
            raise TrainingError("grow_steps needs a range of ages as well: grow, such as 6:12")
        return {}
    growth_schedule(schedule, read_ages(grow), grow_steps or steps)
    return {"grow": grow, "schedule": schedule, "grow_steps": grow_steps or steps}


def growing_opener(
    open_env: Callable[..., InfantEnv], bundle: Bundle, settings: Settings
) -> Callable[[], InfantEnv | Growing]:
    """Return what opens one of the parallel environments of a training, whose infant grows if the settings say so.

    Args:
        open_env: Opens the environment of the bundle; it takes `variants`.
        bundle: The infant.
        settings: Settings of the training run.

    Raises:
        MimocError: If the infant cannot be built at the first or the last age.
    """
    if not settings.growth:
        return open_env
    variants = BundleVariants(bundle)
    for age_months in read_ages(settings.growth["grow"]):
        variants(age_months, bundle.manifest.seed)
    return partial(_open_growing, open_env, variants, dict(settings.growth), settings.envs, settings.seed)


def seek(env: VecNormalize, settings: Settings, steps_done: int) -> None:
    """Let infants that grow go on as after a number of control steps, summed over all environments."""
    if settings.growth:
        env.env_method("seek", steps_done // settings.envs)


def _open_growing(
    open_env: Callable[..., InfantEnv], variants: BundleVariants, growth: Mapping[str, Any], envs: int, seed: int
) -> Growing:
    steps = max(growth["grow_steps"] // envs, 1)
    schedule = growth_schedule(growth["schedule"], read_ages(growth["grow"]), steps, seed=seed)
    return Growing(open_env(variants=variants), schedule)
