"""Stable-Baselines3's PPO and SAC, as mimoc configures them."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.preprocessing import is_image_space
from stable_baselines3.common.vec_env import VecNormalize, VecTransposeImage
from stable_baselines3.ppo import MultiInputPolicy as PPOPolicy
from stable_baselines3.sac import MultiInputPolicy as SACPolicy

from mimoc.training.hyperparameters import Number
from mimoc.training.settings import Settings

_PASSED_ON = {
    "ppo": ("learning_rate", "gamma", "batch_size", "clip_range", "ent_coef", "gae_lambda", "n_epochs", "n_steps"),
    "sac": ("learning_rate", "gamma", "batch_size", "buffer_size", "gradient_steps", "learning_starts", "tau"),
}
"""Hyperparameters passed on to Stable-Baselines3 unchanged."""
_ALGORITHMS: Mapping[str, Callable[..., BaseAlgorithm]] = {"ppo": PPO, "sac": SAC}
_POLICIES: Mapping[str, Callable[..., BasePolicy]] = {"ppo": PPOPolicy, "sac": SACPolicy}


def make_agent(env: VecNormalize, settings: Settings) -> BaseAlgorithm:
    """Return an untrained agent; the same seed gives the same initial weights."""
    return _ALGORITHMS[settings.algo](
        "MultiInputPolicy",
        env,
        policy_kwargs=_network(settings.hyper),
        device="cpu",
        seed=interval_seed(settings.seed, 0),
        **{name: settings.hyper[name] for name in _PASSED_ON[settings.algo]},
    )


def make_policy(algo: str, hyper: Mapping[str, Number], observation_space: Any, action_space: Any) -> BasePolicy:
    """Return the policy network of an algorithm, randomly initialised.

    Args:
        algo: The algorithm.
        hyper: Its hyperparameters.
        observation_space: Gymnasium's dictionary space of the observations.
        action_space: Gymnasium's space of the actions.
    """
    spaces = {
        name: VecTransposeImage.transpose_space(space, name) if is_image_space(space) else space
        for name, space in observation_space.spaces.items()
    }
    network = _network(hyper)
    return _POLICIES[algo](type(observation_space)(spaces), action_space, lambda _: 0.0, **network)


def interval_seed(seed: int, start_steps: int) -> int:
    """Return the seed of the training interval that starts after the given number of steps."""
    return int(np.random.SeedSequence([seed, start_steps]).generate_state(1)[0]) // 2


def start_interval(agent: BaseAlgorithm, seed: int) -> None:
    """Reset all environments and seed all random numbers at the start of a training interval.

    The outcome of an interval thus depends only on the agent's weights and statistics and on the seed.
    """
    agent.set_random_seed(interval_seed(seed, agent.num_timesteps))
    agent._last_obs = None  # Makes `learn` reset the environments.


def has_learnt(agent: BaseAlgorithm) -> bool:
    """Return whether an agent has been updated since it was made or restored."""
    return agent._n_updates > 0  # pyright: ignore[reportAttributeAccessIssue] - Of on- and off-policy algorithms.


def set_weights(agent: BaseAlgorithm, weights: Mapping[str, Any]) -> None:
    """Restore the agent's weights and optimiser states.

    Raises:
        ValueError: If they are those of another agent.
    """
    modules = dict(weights)
    variables = modules.pop(VARIABLES, {})
    agent.set_parameters(modules, device="cpu")
    with torch.no_grad():
        for name in _variables(agent):
            getattr(agent, name).copy_(variables[name])  # In place: an optimiser holds a reference to it.


VARIABLES = "pytorch_variables"
"""Name of these tensors in Stable-Baselines3's files."""


def _variables(agent: BaseAlgorithm) -> list[str]:
    return agent._get_torch_save_params()[1]


def _network(hyper: Mapping[str, Number]) -> dict[str, Any]:
    return {"net_arch": [int(hyper["width"])] * int(hyper["layers"])}
