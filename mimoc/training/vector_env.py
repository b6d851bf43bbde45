"""Parallel environments with normalised observations, for Stable-Baselines3."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import gymnasium
import numpy as np
from gymnasium.wrappers import TimeLimit
from stable_baselines3.common.preprocessing import is_image_space
from stable_baselines3.common.vec_env import (
    DummyVecEnv,
    SubprocVecEnv,
    VecEnv,
    VecEnvWrapper,
    VecMonitor,
    VecNormalize,
    VecTransposeImage,
)
from stable_baselines3.common.vec_env.base_vec_env import VecEnvObs, VecEnvStepReturn

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing_env import Growing
from mimoc.runtime.many.vector_env import ManyInfants
from mimoc.training.growth import Growth
from mimoc.training.sb3_infants import RESET_IN_THE_SAME_STEP, InfantVecEnv
from mimoc.training.settings import Settings


class SinglePrecisionRewards(VecEnvWrapper):
    """Rewards in single precision, as Stable-Baselines3 has them in one process but not in several."""

    def reset(self) -> VecEnvObs:
        """Reset all environments and return their observations."""
        return self.venv.reset()

    def step_wait(self) -> VecEnvStepReturn:
        """Return the result of a step."""
        observations, rewards, dones, infos = self.venv.step_wait()
        return observations, rewards.astype(np.float32), dones, infos


def make_vector_env(
    open_env: Callable[..., InfantEnv],
    settings: Settings,
    growth: Growth | None,
    threads: int | None,
    processes: bool | None,
) -> VecNormalize:
    """Return the parallel environments of a training run.

    Args:
        open_env: Opens one environment.
        settings: Settings of the training run.
        growth: How the infants grow, if they do.
        threads: Threads that share the work; None is as many as there may be. The result of the training is the same.
        processes: Whether to run each environment in a process of its own, or one after another; None is all together.
            The result is the same.
    """
    openers = [partial(open_env, variants=growth.variants) if growth else open_env] * settings.envs
    limit = settings.steps_per_episode
    together = processes is None
    envs = _together(openers, growth, threads, limit) if together else _apart(openers, growth, processes, limit)
    envs = VecMonitor(envs)
    return VecNormalize(
        _channels_first(envs),
        gamma=settings.hyper["gamma"],
        clip_obs=settings.hyper["observation_clip"],
        epsilon=settings.hyper["observation_floor"] ** 2,
        norm_obs_keys=normalized_names(envs.observation_space),
    )


def _channels_first(envs: VecEnv) -> VecEnv:
    """Return environments whose images begin with the channels, as networks take them.

    Stable-Baselines3 would wrap the normalised environments; SAC stores what comes before the normalisation.
    """
    space: Any = envs.observation_space
    return VecTransposeImage(envs) if any(map(is_image_space, space.spaces.values())) else envs


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


def _together(
    openers: Sequence[Callable[[], InfantEnv]], growth: Growth | None, threads: int | None, limit: int | None
) -> VecEnv:
    schedule = growth and growth.schedule
    return InfantVecEnv(ManyInfants(openers, threads, RESET_IN_THE_SAME_STEP, limit, schedule))


def _apart(
    openers: Sequence[Callable[[], InfantEnv]], growth: Growth | None, processes: bool, limit: int | None
) -> VecEnv:
    alone: list[Callable[[], Any]] = [partial(_open_alone, open_env, growth, limit) for open_env in openers]
    return SinglePrecisionRewards(SubprocVecEnv(alone) if processes else DummyVecEnv(alone))


def _open_alone(open_env: Callable[[], InfantEnv], growth: Growth | None, limit: int | None) -> gymnasium.Env:
    infant = open_env()
    limited = infant if limit is None else TimeLimit(infant, limit)
    return Growing(limited, growth.schedule) if growth else limited
