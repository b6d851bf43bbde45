"""Several infants at a time, observed on one scale: what an algorithm learns from."""

import os
from collections.abc import Callable, Sequence
from functools import partial
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecEnvWrapper, VecMonitor, VecNormalize
from stable_baselines3.common.vec_env.base_vec_env import VecEnvObs, VecEnvStepReturn

from mimoc.bundle.folder import Bundle
from mimoc.errors import TrainingError
from mimoc.runtime.env import InfantEnv
from mimoc.training.settings import Settings

LEAST_PICTURE_PX = 36
"""Of a picture that Stable-Baselines3's network for pictures takes."""
PAYS_S = 1.5e-3
"""What a control step must cost for processes to pay: sending it to another and back takes a good part of that."""
TRIED_STEPS = 20


class InSinglePrecision(VecEnvWrapper):
    """Rewards in single precision: so they come from infants in one process, and now from those in several."""

    def reset(self) -> VecEnvObs:
        """Return what is observed at first."""
        return self.venv.reset()

    def step_wait(self) -> VecEnvStepReturn:
        """Return what comes of a step."""
        observations, rewards, dones, infos = self.venv.step_wait()
        return observations, rewards.astype(np.float32), dones, infos


def check_learnable(bundle: Bundle) -> None:
    """Refuse an infant that no network can learn from.

    Raises:
        TrainingError: If what it sees is too small, or it takes no commands.
    """
    if not any(actuator.commanded for actuator in bundle.manifest.actuation.actuators):
        raise TrainingError("this infant takes no commands, so there is nothing to learn; give it actuation.regions")
    vision = bundle.manifest.senses.vision
    if vision and min(vision.width_px, vision.height_px) < LEAST_PICTURE_PX:
        size = f"{vision.width_px} x {vision.height_px}"
        raise TrainingError(f"pictures of {size} px are too small to learn from; give {LEAST_PICTURE_PX} or more")


def open_world(bundle: Bundle, settings: Settings, processes: bool | None) -> VecNormalize:
    """Open the infants of a training.

    Args:
        bundle: Which infant.
        settings: How it is trained.
        processes: Whether each has a process of its own; None is where that pays. What is learned is the same.
    """
    openers: list[Callable[[], Any]] = [partial(InfantEnv, bundle)] * settings.envs
    if processes is None:
        processes = settings.envs > 1 and (os.cpu_count() or 1) > 1 and _costs_s(bundle) > PAYS_S
    infants = VecMonitor(InSinglePrecision(SubprocVecEnv(openers) if processes else DummyVecEnv(openers)))
    return VecNormalize(
        infants,
        gamma=settings.hyper["gamma"],
        clip_obs=settings.hyper["observation_clip"],
        epsilon=settings.hyper["observation_floor"] ** 2,
        norm_obs_keys=scaled(infants.observation_space),
    )


def scaled(space: Any) -> list[str]:
    """Return which observations are put on one scale: all but pictures."""
    return [name for name, part in space.spaces.items() if part.dtype != np.uint8]


def statistics(world: VecNormalize) -> dict[str, np.ndarray]:
    """Return what is known of the observations and the return: count, mean and variance of each, by name."""
    return {
        f"{name}.{what}": np.asarray(getattr(part, what), np.float64)
        for name, part in _parts(world).items()
        for what in STATISTICS
    }


def set_statistics(world: VecNormalize, known: dict[str, np.ndarray]) -> None:
    """Go back to what was known."""
    for name, part in _parts(world).items():
        for what in STATISTICS:
            value = known[f"{name}.{what}"]
            setattr(part, what, float(value) if value.ndim == 0 else value.copy())


STATISTICS: Sequence[str] = ("mean", "var", "count")


def _parts(world: VecNormalize) -> dict[str, Any]:
    assert isinstance(world.obs_rms, dict)
    return {**world.obs_rms, "return": world.ret_rms}


def _costs_s(bundle: Bundle) -> float:
    """Return what a control step costs, in [s]; on a machine with other work to do too much."""
    env = InfantEnv(bundle)
    env.action_space.seed(0)
    env.reset(seed=0)
    took_s = []
    for _ in range(TRIED_STEPS):
        action = env.action_space.sample()
        start = perf_counter()
        env.step(action)
        took_s.append(perf_counter() - start)
    env.close()
    return median(took_s)
