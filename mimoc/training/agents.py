"""The algorithms of Stable-Baselines3, as mimoc uses them."""

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

from mimoc.training.hyper import Number
from mimoc.training.settings import Settings

Hyper = Mapping[str, Number]

_TAKEN_AS_THEY_ARE = {
    "ppo": ("learning_rate", "gamma", "batch_size", "clip_range", "ent_coef", "gae_lambda", "n_epochs", "n_steps"),
    "sac": ("learning_rate", "gamma", "batch_size", "buffer_size", "gradient_steps", "learning_starts", "tau"),
}
_ALGORITHMS: Mapping[str, Callable[..., BaseAlgorithm]] = {"ppo": PPO, "sac": SAC}
_POLICIES: Mapping[str, Callable[..., BasePolicy]] = {"ppo": PPOPolicy, "sac": SACPolicy}


def make_agent(world: VecNormalize, settings: Settings) -> BaseAlgorithm:
    """Return an algorithm that has learned nothing yet, the same for the same seed."""
    taken = {name: settings.hyper[name] for name in _TAKEN_AS_THEY_ARE[settings.algo]}
    return _ALGORITHMS[settings.algo](
        "MultiInputPolicy",
        world,
        policy_kwargs=_network(settings.hyper),
        device="cpu",
        seed=draw_seed(settings.seed, 0),
        **taken,
    )


def make_policy(algo: str, hyper: Hyper, observed: Any, commanded: Any) -> BasePolicy:
    """Return the policy of an algorithm, with weights drawn by chance.

    Args:
        algo: The algorithm.
        hyper: Its hyper-parameters.
        observed: Gymnasium's space of the observations of an environment.
        commanded: That of its actions.
    """
    spaces = {
        name: VecTransposeImage.transpose_space(part, name) if is_image_space(part) else part
        for name, part in observed.spaces.items()
    }
    return _POLICIES[algo](type(observed)(spaces), commanded, lambda _: 0.0, **_network(hyper))


def draw_seed(seed: int, begin: int) -> int:
    """Return the seed of the interval that begins at some steps."""
    return int(np.random.SeedSequence([seed, begin]).generate_state(1)[0]) // 2


def begin_interval(agent: BaseAlgorithm, seed: int) -> None:
    """Let an interval of training begin with every episode anew and all chance from the seed.

    So what is learned in it depends on nothing but the agent's weights and statistics, and on the seed.
    """
    agent.set_random_seed(draw_seed(seed, agent.num_timesteps))
    agent._last_obs = None  # Has `learn` reset the environments.


def set_weights(agent: BaseAlgorithm, known: Mapping[str, Any]) -> None:
    """Go back to what was learned.

    Raises:
        ValueError: If it is that of another agent.
    """
    modules = dict(known)
    variables = modules.pop(VARIABLES, {})
    agent.set_parameters(modules, device="cpu")
    with torch.no_grad():
        for name in _variables(agent):
            getattr(agent, name).copy_(variables[name])  # In place: an optimiser holds on to it.


VARIABLES = "pytorch_variables"
"""What Stable-Baselines3 calls them in its files."""


def _variables(agent: BaseAlgorithm) -> list[str]:
    return agent._get_torch_save_params()[1]


def _network(hyper: Hyper) -> dict[str, Any]:
    return {"net_arch": [int(hyper["width"])] * int(hyper["layers"])}
