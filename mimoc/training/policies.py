"""Trained policies: self-contained files that are loaded without running any code from them."""

import io
import json
import math
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.base.errors import PolicyError
from mimoc.bundle.arrays import pack_arrays
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.policies.policy_file import (
    ABOUT,
    DAMAGED,
    NOT_A_POLICY,
    OF_AGENT,
    WEIGHTS,
    PolicyFile,
    check_fits,
    interface_of,
    spaces_of,
)
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation
from mimoc.training.agents import make_policy, set_weights, weights_of
from mimoc.training.settings import TrainingSettings, complete
from mimoc.training.vector_env import normalized_names, statistics

SCALE = "scale.npz"
"""The file in a policy archive with the statistics of the observations. What mimoc does not read is for
Stable-Baselines3, whose `load` accepts the archive too and unpickles it; mimoc never does."""
OF_TORCH = "policy.pth"
"""The weights, for Stable-Baselines3."""


@dataclass(frozen=True)
class TrainedPolicy:
    """A deterministic policy: the same observation always gives the same action, without exploration."""

    network: BasePolicy
    scale: Mapping[str, tuple[np.ndarray, np.ndarray]]
    """Mean and standard deviation of each observation that is normalised, by name."""
    clip: float
    """Absolute value at which normalised observations are clipped."""
    steps_per_episode: int | None = None
    """Control steps after which an episode of its training was truncated; None if that is not known."""

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action for an observation, shape (n,); *generator* is not used."""
        inputs = dict(observation)
        for name, (mean, deviation) in self.scale.items():
            normalized = (observation[name] - mean) / deviation
            inputs[name] = np.clip(normalized, -self.clip, self.clip).astype(np.float32)
        try:
            action = self.network.predict(inputs, deterministic=True)[0]
        except ValueError:  # A distribution of numbers that are not finite.
            action = np.array(np.nan)
        if not np.isfinite(action).all():
            raise PolicyError("this policy gives commands that are not finite; train it again")
        return action


def pack_policy(agent: BaseAlgorithm, vector_env: VecNormalize, settings: TrainingSettings, env: Infant) -> bytes:
    """Return the content of an agent's policy file, for `load_policy`."""
    content = io.BytesIO()
    agent.save(content)
    about = {
        "policy": OF_AGENT,
        "infant": env.manifest.name,
        "steps": agent.num_timesteps,
        "settings": settings.data(),
        **interface_of(env),
    }
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(ABOUT, json.dumps(about, indent=1))
        archive.writestr(SCALE, pack_arrays(statistics(vector_env)))
        archive.writestr(WEIGHTS, pack_arrays(weights_of(agent.policy)), zipfile.ZIP_STORED)
    return content.getvalue()


def load_agent(file: PolicyFile) -> PolicyMaker:
    """Return the policy in a file of one that was trained by Stable-Baselines3.

    The returned function raises a PolicyError for an infant whose observations or actuators differ from those of the
    trained infant.

    Raises:
        PolicyError: If it is damaged.
    """
    path, about = file.path, file.about
    try:
        known, weights = file.arrays(SCALE), file.arrays(WEIGHTS)
        if not all(np.isfinite(array).all() for array in (*known.values(), *weights.values())):
            raise ValueError("numbers that are not finite")
        hyper = complete(about["settings"]["algo"], about["settings"]["hyper"])
    except DAMAGED:
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    return lambda env: _bind(path, about, hyper, known, weights, env)


def _bind(
    path: Path,
    about: dict[str, Any],
    hyper: Mapping[str, Any],
    known: Mapping[str, np.ndarray],
    weights: Mapping[str, np.ndarray],
    env: Infant,
) -> Policy:
    check_fits(path, about, interface_of(env))
    scale = dict[str, tuple[np.ndarray, np.ndarray]]()
    try:
        width, layers = int(hyper["width"]), int(hyper["layers"])
        inputs = sum(math.prod(space.shape) for space in spaces_of(env).values() if len(space.shape) == 1)
        if width * (inputs + width * (layers - 1)) > sum(array.size for array in weights.values()):
            raise ValueError("fewer weights than its layers have")
        network = make_policy(about["settings"]["algo"], hyper, env.observation_space, env.action_space)
        set_weights(network, weights)
        for name in normalized_names(env.observation_space):
            mean, variance = known[f"{name}.mean"], np.maximum(known[f"{name}.var"], 0.0)
            if not mean.shape == variance.shape == spaces_of(env)[name].shape:
                raise ValueError(f"the statistics of '{name}' are of another shape")
            scale[name] = mean, np.sqrt(variance + hyper["observation_floor"] ** 2)
    except (KeyError, RuntimeError, ValueError, TypeError, AttributeError):
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    network.set_training_mode(False)
    limit = about["settings"].get("steps_per_episode")
    return TrainedPolicy(network, scale, float(hyper["observation_clip"]), limit)
