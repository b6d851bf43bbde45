"""Training of an infant that grows."""

from dataclasses import dataclass
from typing import Any

from stable_baselines3.common.vec_env import VecNormalize

from mimoc.bundle.io import Bundle
from mimoc.compiler.variants import BundleVariants
from mimoc.errors import TrainingError
from mimoc.runtime.growing import check_same_body
from mimoc.runtime.growth_schedule import GrowthSchedule, growth_schedule, read_ages
from mimoc.training.sb3_infants import InfantVecEnv
from mimoc.training.settings import Settings

GROWN = "grown"
"""The schedule if none is given."""


def growth_settings(grow: str | None, schedule: str, grow_steps: int | None, steps: int) -> dict[str, Any]:
    """Return the settings of growth: none without a range of ages.

    Args:
        grow: The youngest and the oldest age in months, such as `6:12`; None if the infant does not grow.
        schedule: In which order it has these ages.
        grow_steps: Control steps that growth takes, summed over all environments; None is the whole training.
        steps: Control steps of the training.

    Raises:
        MimocError: If this is no range of ages, no schedule, or no number of steps.
        TrainingError: If there is a schedule or a number of steps without a range of ages.
    """
    if grow is None:
        if schedule != GROWN or grow_steps is not None:
            name = "schedule" if schedule != GROWN else "grow_steps"
            raise TrainingError(f"{name} needs a range of ages as well: grow, such as 6:12")
        return {}
    growth_schedule(schedule, read_ages(grow), grow_steps or steps)
    return {"grow": grow, "schedule": schedule, "grow_steps": grow_steps or steps}


@dataclass(frozen=True, slots=True)
class Growth:
    """How the infants of a training grow, all alike."""

    schedule: GrowthSchedule
    """Their age by the control steps that each has taken."""
    variants: BundleVariants
    """The infant at each age."""


def growth_of(bundle: Bundle, settings: Settings) -> Growth | None:
    """Return how the infants of a training grow, if the settings say so.

    Args:
        bundle: The infant.
        settings: Settings of the training run.

    Raises:
        MimocError: If the infant cannot be built at the first or the last age, or has other parts there.
    """
    if not settings.growth:
        return None
    growth, variants = settings.growth, BundleVariants(bundle)
    ages_months = read_ages(growth["grow"])
    youngest, oldest = (variants(age_months, bundle.manifest.seed) for age_months in ages_months)
    check_same_body(youngest.model, oldest.model)
    steps = max(growth["grow_steps"] // settings.envs, 1)
    return Growth(growth_schedule(growth["schedule"], ages_months, steps, seed=settings.seed), variants)


def seek(env: VecNormalize, settings: Settings, steps_done: int) -> None:
    """Let infants that grow go on as after a number of control steps, summed over all environments."""
    if not settings.growth:
        return
    if isinstance(env.unwrapped, InfantVecEnv):
        env.unwrapped.seek(steps_done // settings.envs)
    else:
        env.env_method("seek", steps_done // settings.envs)
