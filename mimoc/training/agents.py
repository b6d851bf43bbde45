"""Stable-Baselines3's PPO and SAC, as mimoc configures them."""

import io
import json
import math
import zipfile
from collections.abc import Callable, Mapping
from functools import partial
from operator import attrgetter
from pathlib import Path
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
    TrainedPolicy,
    check_fits,
    interface_of,
    spaces_of,
)
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation
from mimoc.training.settings import Number, TrainingSettings, complete
from mimoc.training.vector_env import normalized_names, statistics

_PASSED_ON = {
    "ppo": ("learning_rate", "gamma", "batch_size", "clip_range", "ent_coef", "gae_lambda", "n_epochs", "n_steps"),
    "sac": ("learning_rate", "gamma", "batch_size", "buffer_size", "gradient_steps", "learning_starts", "tau"),
}
"""Hyperparameters passed on to Stable-Baselines3 unchanged."""
_ALGORITHMS: Mapping[str, Callable[..., BaseAlgorithm]] = {"ppo": PPO, "sac": SAC}
_POLICIES: Mapping[str, Callable[..., BasePolicy]] = {"ppo": PPOPolicy, "sac": SACPolicy}


Modules = Mapping[str, Any]


def make_agent(env: VecNormalize, settings: TrainingSettings) -> BaseAlgorithm:
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
    """Return the policy network of an algorithm for Gymnasium's spaces, randomly initialised."""
    spaces = {
        name: VecTransposeImage.transpose_space(space, name) if is_image_space(space) else space
        for name, space in observation_space.spaces.items()
    }
    network = _network(hyper)
    return _POLICIES[algo](type(observation_space)(spaces), action_space, lambda _: 0.0, **network)


def torch_devices() -> str:
    """Return what torch can compute on: `CUDA 12.8, NVIDIA H200`, say, or `CPU only`."""
    if not torch.cuda.is_available():
        return "CPU only"
    names = dict.fromkeys(torch.cuda.get_device_name(index) for index in range(torch.cuda.device_count()))
    return f"CUDA {torch.version.cuda}, {', '.join(names)}"


def interval_seed(seed: int, start_steps: int) -> int:
    """Return the seed of the training interval that starts after the given number of steps."""
    return int(np.random.SeedSequence([seed, start_steps]).generate_state(1)[0]) // 2


def start_interval(agent: BaseAlgorithm, seed: int) -> None:
    """Reset all environments and seed all random numbers at the start of a training interval.

    The outcome of an interval thus depends only on the agent's weights and statistics and on the seed.
    """
    agent.set_random_seed(interval_seed(seed, agent.num_timesteps))
    agent._last_obs = None  # Makes `learn` reset the environments.


def weights_of(module: torch.nn.Module) -> dict[str, np.ndarray]:
    """Return the weights of a network, by their names in it."""
    return {name: tensor.numpy(force=True) for name, tensor in module.state_dict().items()}


def set_weights(module: torch.nn.Module, weights: Mapping[str, np.ndarray]) -> None:
    """Set the weights of a network, or raise a RuntimeError if they are those of another one."""
    module.load_state_dict({name: torch.from_numpy(array.copy()) for name, array in weights.items()})


def agent_state(agent: BaseAlgorithm) -> dict[str, np.ndarray]:
    """Return weights, states of optimisers and other variables that an agent learns, to go on from.

    Names are those of networks' weights (`policy/log_std`), of what an optimiser knows of a parameter, by its number
    (`policy.optimizer/0/exp_avg`), and of variables (`log_ent_coef`).
    """
    modules, variables = _learnt(agent)
    return {**{name: getattr(agent, name).numpy(force=True) for name in variables}, **state_of(modules)}


def state_of(modules: Modules) -> dict[str, np.ndarray]:
    """Return the weights of networks and what optimisers know, with names as in `agent_state`."""
    state = dict[str, np.ndarray]()
    for name, module in modules.items():
        if isinstance(module, torch.optim.Optimizer):
            known = module.state_dict()["state"].items()
            state |= {f"{name}/{number}/{key}": part[key].numpy(force=True) for number, part in known for key in ADAM}
        else:
            state |= {f"{name}/{key}": array for key, array in weights_of(module).items()}
    return state


def restore_agent(agent: BaseAlgorithm, state: Mapping[str, np.ndarray]) -> None:
    """Restore what `agent_state` has returned; raise a Key-, Runtime- or ValueError if it is of another agent."""
    modules, variables = _learnt(agent)
    restore_state(modules, state)
    with torch.no_grad():
        for name in variables:  # In place: an optimiser holds a reference to it.
            getattr(agent, name).copy_(torch.from_numpy(state[name].copy()))


def restore_state(modules: Modules, state: Mapping[str, np.ndarray]) -> None:
    """Restore what `state_of` has returned; raise a Key-, Runtime- or ValueError if it is of other networks."""
    for name, module in modules.items():
        part = {key.removeprefix(f"{name}/"): array for key, array in state.items() if key.startswith(f"{name}/")}
        if isinstance(module, torch.optim.Optimizer):
            _restore_optimiser(module, part)
        else:
            set_weights(module, part)


ADAM = ("step", "exp_avg", "exp_avg_sq")  # What PyTorch's Adam, which all agents learn with, knows of a parameter.


def _restore_optimiser(optimiser: torch.optim.Optimizer, saved: Mapping[str, np.ndarray]) -> None:
    parameters = [parameter for group in optimiser.param_groups for parameter in group["params"]]
    known = {number: part for number, part in enumerate(parameters) if f"{number}/{ADAM[0]}" in saved}
    shapes = {f"{number}/{key}": () if key == "step" else part.shape for number, part in known.items() for key in ADAM}
    if shapes != {name: array.shape for name, array in saved.items()}:
        raise ValueError("an optimiser of other parameters")
    state = {number: {key: torch.from_numpy(saved[f"{number}/{key}"].copy()) for key in ADAM} for number in known}
    optimiser.load_state_dict({"state": state, "param_groups": optimiser.state_dict()["param_groups"]})


def _learnt(agent: BaseAlgorithm) -> "tuple[dict[str, torch.nn.Module | torch.optim.Optimizer], list[str]]":
    """Return the networks and optimisers of an agent by name, and the names of its other variables."""
    names, variables = agent._get_torch_save_params()
    return {name: attrgetter(name)(agent) for name in names}, variables


def _network(hyper: Mapping[str, Number]) -> dict[str, Any]:
    return {"net_arch": [int(hyper["width"])] * int(hyper["layers"])}


SCALE = "scale.npz"
"""The file in a policy archive with the statistics of the observations. What mimoc does not read is for
Stable-Baselines3, whose `load` accepts the archive too and unpickles it; mimoc never does."""
OF_TORCH = "policy.pth"  # The weights, for Stable-Baselines3.


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
    act = partial(_act, network, scale, float(hyper["observation_clip"]))
    return TrainedPolicy(act, about["settings"].get("steps_per_episode"))


def _act(
    network: BasePolicy, scale: Mapping[str, tuple[np.ndarray, np.ndarray]], clip: float, observation: Observation
) -> np.ndarray:
    """Return the action for an observation, of which what has a mean and a deviation is normalised and clipped."""
    inputs = dict(observation)
    for name, (mean, deviation) in scale.items():
        inputs[name] = np.clip((observation[name] - mean) / deviation, -clip, clip).astype(np.float32)
    try:
        return network.predict(inputs, deterministic=True)[0]
    except ValueError:  # A distribution of numbers that are not finite.
        return np.array(np.nan)
