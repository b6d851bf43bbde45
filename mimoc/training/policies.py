"""Trained policies: self-contained files that are loaded without running any code from them."""

import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.errors import MimocError, PolicyError, UnknownNameError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.rollout import Policy, PolicyMaker
from mimoc.senses.sense import Observation
from mimoc.training.agents import make_policy
from mimoc.training.hyperparameters import complete
from mimoc.training.settings import Settings
from mimoc.training.vector_env import normalized_names, statistics

ABOUT, SCALE, WEIGHTS = "mimoc.json", "scale.npz", "policy.pth"
"""The files in a policy archive that mimoc reads: description, statistics of the observations, and weights. The others
are for Stable-Baselines3, whose `load` accepts the archive too and unpickles them; mimoc never does."""
VERSION = 1
DAMAGED = (zipfile.BadZipFile, KeyError, ValueError, TypeError, RuntimeError, EOFError, OSError, MimocError)
"""Exceptions that reading a file that is not a policy may raise."""


@dataclass(frozen=True)
class TrainedPolicy:
    """A deterministic policy: the same observation always gives the same action, without exploration."""

    network: BasePolicy
    scale: Mapping[str, np.ndarray]
    """Mean and standard deviation of each normalised observation, by name."""
    clip: float
    """Absolute value at which normalised observations are clipped."""
    normalized: Sequence[str]
    """Names of the observations to normalise."""

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action for an observation, shape (n,); *generator* is not used."""
        inputs = {
            name: self._normalize(name, part) if name in self.normalized else part for name, part in observation.items()
        }
        return self.network.predict(inputs, deterministic=True)[0]

    def _normalize(self, name: str, part: np.ndarray) -> np.ndarray:
        normalized = (part - self.scale[f"{name}.mean"]) / self.scale[f"{name}.deviation"]
        return np.clip(normalized, -self.clip, self.clip).astype(np.float32)


def pack_policy(agent: BaseAlgorithm, vector_env: VecNormalize, settings: Settings, env: InfantEnv) -> bytes:
    """Return the content of an agent's policy file, for `load_policy`."""
    content = io.BytesIO()
    agent.save(content)
    about = {
        "policy": VERSION,
        "infant": env.manifest.name,
        "steps": agent.num_timesteps,
        "settings": settings.data(),
        "observes": describe_observations(env),
        "commands": commanded_actuators(env),
    }
    scale, known = io.BytesIO(), dict[str, Any](statistics(vector_env))
    np.savez(scale, **known)
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(ABOUT, json.dumps(about, indent=1))
        archive.writestr(SCALE, scale.getvalue())
    return content.getvalue()


def load_policy(path: str | Path) -> PolicyMaker:
    """Load a trained policy; return a function that binds it to an environment, for `Run` and `evaluate`.

    Loading a policy runs no code from its file. The returned function raises a PolicyError for an infant whose
    observations or actuators differ from those of the trained infant.

    Raises:
        PolicyError: If the file is not a policy trained by mimoc.
    """
    path = Path(path).expanduser()
    if not path.is_file():
        raise PolicyError(f"{path}: there is no such file; name the policy.zip of a training run")
    try:
        about, statistics_, network = _read(path)
        hyper = complete(about["settings"]["algo"], about["settings"]["hyper"])
    except DAMAGED:
        raise PolicyError(f"{path}: not a policy trained by mimoc, or it is damaged") from None
    return lambda env: _bind(path, about, hyper, statistics_, network, env)


def read_tensors(content: bytes) -> Any:
    """Return the tensors in a file of torch's; anything else in it is refused.

    Raises:
        ValueError: If the file holds anything but tensors, or is damaged.
    """
    try:
        return torch.load(io.BytesIO(content), map_location="cpu", weights_only=True)
    except Exception as error:  # Torch does not document what it raises on damaged files.
        raise ValueError(f"no tensors: {error}") from None


def describe_observations(env: InfantEnv) -> dict[str, Any]:
    """Return the shape and layout (the meaning of each number; empty for images) of each observation, by name."""
    return {name: {"shape": list(part.shape), "layout": _layout(env, name)} for name, part in _spaces(env).items()}


def commanded_actuators(env: InfantEnv) -> list[str]:
    """Return the names of the actuators that the action commands, in its order."""
    return [actuator.name for actuator in env.manifest.actuation.actuators if actuator.commanded]


def _read(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray], dict[str, torch.Tensor]]:
    with zipfile.ZipFile(path) as archive:
        about = json.loads(archive.read(ABOUT))
        if about["policy"] != VERSION:
            raise PolicyError(f"{path}: this policy was saved by an incompatible version of mimoc")
        with np.load(io.BytesIO(archive.read(SCALE)), allow_pickle=False) as file:
            known = dict(file)
        return about, known, read_tensors(archive.read(WEIGHTS))


def _bind(
    path: Path,
    about: dict[str, Any],
    hyper: Mapping[str, Any],
    known: Mapping[str, np.ndarray],
    weights: Mapping[str, torch.Tensor],
    env: InfantEnv,
) -> Policy:
    """Return the policy for an environment; raise a PolicyError if it does not fit."""
    differences = [
        *_differing_observations(about["observes"], describe_observations(env)),
        *_differing_actuators(about["commands"], commanded_actuators(env)),
    ]
    if differences:
        raise PolicyError(f"{path}: trained for a different infant, '{about['infant']}': {'; '.join(differences)}")
    network = make_policy(about["settings"]["algo"], hyper, env.observation_space, env.action_space)
    names = normalized_names(env.observation_space)
    try:
        network.load_state_dict(weights)
        means = {f"{name}.mean": known[f"{name}.mean"] for name in names}
        floor = hyper["observation_floor"]
        deviations = {f"{name}.deviation": np.sqrt(known[f"{name}.var"] + floor**2) for name in names}
    except (KeyError, RuntimeError):
        raise PolicyError(f"{path}: not a policy trained by mimoc, or it is damaged") from None
    network.set_training_mode(False)
    return TrainedPolicy(network, {**means, **deviations}, float(hyper["observation_clip"]), names)


def _differing_observations(trained: Mapping[str, Any], here: Mapping[str, Any]) -> list[str]:
    found = [f"observation '{name}' is missing here" for name in trained.keys() - here.keys()]
    found += [f"observation '{name}' was not there in training" for name in here.keys() - trained.keys()]
    for name in sorted(trained.keys() & here.keys()):
        if (then := trained[name]["shape"]) != (now := here[name]["shape"]):
            found.append(f"'{name}' had shape {_shape(then)} in training and has {_shape(now)} here")
        else:
            found += _first_difference(f"'{name}'", trained[name]["layout"], here[name]["layout"])
    return sorted(found)


def _differing_actuators(trained: Sequence[str], here: Sequence[str]) -> list[str]:
    if len(trained) != len(here):
        return [f"the action commanded {len(trained)} actuators in training and commands {len(here)} here"]
    return _first_difference("the action", trained, here)


def _first_difference(what: str, trained: Sequence[str], here: Sequence[str]) -> list[str]:
    for number, (then, now) in enumerate(zip(trained, here, strict=False)):
        if then != now:
            return [f"element {number} of {what} was {then} in training and is {now} here"]
    return []


def _shape(sizes: Sequence[int]) -> str:
    return str(tuple(sizes))


def _spaces(env: InfantEnv) -> Mapping[str, Any]:
    space: Any = env.observation_space
    return space.spaces


def _layout(env: InfantEnv, name: str) -> list[str]:
    try:
        return list(env.layout(name))
    except UnknownNameError:  # An image, or an observation of the task.
        return []
