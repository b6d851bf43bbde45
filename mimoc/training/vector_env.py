"""Parallel environments with normalised observations, for Stable-Baselines3, of infants that may grow."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import TimeLimit, TransformReward
from stable_baselines3.common.preprocessing import is_image_space
from stable_baselines3.common.vec_env import (
    DummyVecEnv,
    SubprocVecEnv,
    VecEnv,
    VecMonitor,
    VecNormalize,
    VecTransposeImage,
)
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvObs, VecEnvStepReturn

from mimoc.base.errors import TrainingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.world import WorldBundle
from mimoc.compiler.variants import WorldBundleVariants
from mimoc.runtime.batch_env import BatchEnv
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import check_same_body
from mimoc.runtime.growth_wrapper import GrowthSchedule, GrowthWrapper, growth_schedule, read_ages
from mimoc.runtime.opening import BundleVariants
from mimoc.runtime.world_env import WorldEnv
from mimoc.training.settings import TrainingSettings

RESET_IN_THE_SAME_STEP = AutoresetMode.SAME_STEP  # What Stable-Baselines3 expects of its environments.


class InfantVecEnv(DummyVecEnv):
    """Stable-Baselines3's view of many infants: those whose episode ends are reset in the same step.

    The `info` of a last step has what was observed then as `terminal_observation`, and `TimeLimit.truncated`.
    Attributes and methods of single infants are reached as in its `DummyVecEnv`.
    """

    def __init__(self, infants: BatchEnv):
        assert infants.autoreset_mode == RESET_IN_THE_SAME_STEP
        self.infants = infants
        VecEnv.__init__(self, infants.num_envs, infants.single_observation_space, infants.single_action_space)

    def reset(self) -> VecEnvObs:
        """Reset all infants with the seeds and options that were set, and return what they observe."""
        seeds, options = list(self._seeds), list(self._options)
        observation, infos = self.infants.reset_each(seeds, options)
        self.reset_infos = [infos[infant] for infant in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        return observation

    def step_wait(self) -> VecEnvStepReturn:
        """Make the step; rewards are in single precision."""
        observation, rewards, terminated, truncated, infos = self.infants.step_each(self.actions)
        done = terminated | truncated
        last_infos = []
        for infant in range(self.num_envs):
            info = infos[infant]
            if done[infant]:
                final, last = info.pop("final_obs"), info.pop("final_info")
                self.reset_infos[infant] = info
                info = {**last, "terminal_observation": final}
            info["TimeLimit.truncated"] = bool(truncated[infant] and not terminated[infant])
            last_infos.append(info)
        return observation, rewards.astype(np.float32), done, last_infos

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of each infant."""
        return [getattr(self.infants.infants[index], attr_name) for index in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set an attribute of each infant."""
        for index in self._get_indices(indices):
            setattr(self.infants.infants[index], attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **kwargs: Any
    ) -> list[Any]:
        """Call a method of each infant."""
        return [method(*method_args, **kwargs) for method in self.get_attr(method_name, indices)]

    def env_is_wrapped(self, wrapper_class: Any, indices: VecEnvIndices = None) -> list[bool]:
        """Return that no infant is wrapped."""
        return [False for _ in self._get_indices(indices)]

    def close(self) -> None:
        """Close all infants; closing twice is fine."""
        self.infants.close()

    def get_images(self) -> list[npt.NDArray[np.uint8] | None]:
        """Return a picture of each infant."""
        return self.env_method("render")


def monitored(infants: BatchEnv) -> VecMonitor:
    """Return infants that are reset in the same step as Stable-Baselines3 wants them, with returns of episodes."""
    return Monitored(InfantVecEnv(infants))


class Monitored(VecMonitor):
    """Stable-Baselines3's `VecMonitor`, which can be copied and pickled."""

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the members of the class, which it keeps beside its own attributes."""
        return {name: value for name, value in self.__dict__.items() if name != CLASS_ATTRIBUTES}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take them from the class again."""
        vars(self).update(state, **{CLASS_ATTRIBUTES: dict(inspect.getmembers(type(self)))})


CLASS_ATTRIBUTES = "class_attributes"  # Attribute of Stable-Baselines3's wrappers with the members of their class.


GROWN = "grown"


def growth_settings(grow: str | None, schedule: str, grow_steps: int | None, steps: int) -> dict[str, Any]:
    """Return the settings of growth, see `train`: none without a range of ages."""
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

    schedule: GrowthSchedule  # Their age by the control steps that each has taken.
    variants: BundleVariants | WorldBundleVariants  # The infant, or all of a world, at each age.


def growth_of(bundle: Bundle | WorldBundle, settings: TrainingSettings) -> Growth | None:
    """Return how the infants of a training grow, if they do, or raise a MimocError if an age cannot be built."""
    if not settings.growth:
        return None
    growth, seed = settings.growth, bundle.manifest.seed
    ages_months = read_ages(growth["grow"])
    variants: Any = BundleVariants(bundle) if isinstance(bundle, Bundle) else WorldBundleVariants(bundle)
    wanted = [age if isinstance(bundle, Bundle) else dict.fromkeys(bundle.infants, age) for age in ages_months]
    youngest, oldest = (variants(age, seed) for age in wanted)
    check_same_body(youngest.model, oldest.model)
    steps = max(growth["grow_steps"] // settings.envs, 1)
    return Growth(growth_schedule(growth["schedule"], ages_months, steps, seed=settings.seed), variants)


def seek(env: VecNormalize, settings: TrainingSettings, steps_done: int) -> None:
    """Let infants that grow go on as after a number of control steps, summed over all environments."""
    if not settings.growth:
        return
    if isinstance(env.unwrapped, InfantVecEnv):
        env.unwrapped.infants.seek(steps_done // settings.envs)
    else:
        env.env_method("seek", steps_done // settings.envs)


def rows_together(
    open_one: Callable[..., InfantEnv | WorldEnv],
    settings: TrainingSettings,
    growth: Growth | None,
    threads: int | None,
    processes: bool | None,
    infants: int = 1,
) -> VecEnv:
    """Return the infants of a training run, a row each; see `train` for *threads* and *processes*.

    Each world has so many *infants*; those of worlds with several are worked through together.
    """
    openers: list[Any] = [partial(open_one, variants=growth.variants) if growth else open_one]
    openers *= settings.envs // infants
    limit = settings.steps_per_episode
    if processes is None:
        schedule = growth and growth.schedule
        return InfantVecEnv(BatchEnv(openers, threads, RESET_IN_THE_SAME_STEP, limit, schedule))
    alone: list[Callable[[], Any]] = [partial(_open_alone, opener, growth, limit) for opener in openers]
    return SubprocVecEnv(alone) if processes else DummyVecEnv(alone)


def normalized(open_rows: Callable[[], VecEnv], settings: TrainingSettings) -> VecNormalize:
    """Return the infants of a training run with returns of episodes, and with normalised observations."""
    envs: VecEnv = VecMonitor(open_rows())
    spaces: Any = envs.observation_space
    if any(map(is_image_space, spaces.values())):  # SAC stores what comes before the normalisation.
        envs = VecTransposeImage(envs)
    return VecNormalize(
        envs,
        gamma=settings.hyper["gamma"],
        clip_obs=settings.hyper["observation_clip"],
        epsilon=settings.hyper["observation_floor"] ** 2,
        norm_obs_keys=normalized_names(spaces),
    )


def normalized_names(space: Any) -> list[str]:
    """Return the names of the observations that are normalised: all but images."""
    return [name for name, part in space.spaces.items() if part.dtype != np.uint8]


def statistics(env: VecNormalize) -> dict[str, np.ndarray]:
    """Return mean, variance and count of each observation and of the return, by name."""
    return {
        f"{name}.{what}": np.asarray(getattr(running, what), np.float64)
        for name, running in _running_statistics(env).items()
        for what in STATISTICS
    }


def set_statistics(env: VecNormalize, saved: Mapping[str, np.ndarray]) -> None:
    """Restore the statistics."""
    for name, running in _running_statistics(env).items():
        for what in STATISTICS:
            value = saved[f"{name}.{what}"]
            setattr(running, what, float(value) if value.ndim == 0 else value.copy())


STATISTICS: Sequence[str] = ("mean", "var", "count")


def _running_statistics(env: VecNormalize) -> dict[str, Any]:
    assert isinstance(env.obs_rms, dict)
    return {**env.obs_rms, "return": env.ret_rms}


def _open_alone(open_env: Callable[[], InfantEnv], growth: Growth | None, limit: int | None) -> gymnasium.Env:
    """Open one environment, with rewards in single precision, as Stable-Baselines3 has them in one process."""
    env: gymnasium.Env = open_env()
    env = env if limit is None else TimeLimit(env, limit)
    return TransformReward(GrowthWrapper(env, growth.schedule) if growth else env, np.float32)
