"""Trained policies: one file each, which holds all that is needed to act and nothing that runs when it is read."""

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
from mimoc.training.hyper import complete
from mimoc.training.settings import Settings
from mimoc.training.worlds import scaled, statistics

ABOUT, SCALE, WEIGHTS = "mimoc.json", "scale.npz", "policy.pth"
"""Of the files in a policy's: what it is of, statistics of what it observes, and the state of its networks. The others
are Stable-Baselines3's, whose `load` takes the file too; it runs what is in them, while mimoc does not read them."""
VERSION = 1
DAMAGED = (zipfile.BadZipFile, KeyError, ValueError, TypeError, RuntimeError, EOFError, OSError, MimocError)
"""What reading a file that is no policy may raise."""


@dataclass(frozen=True)
class TrainedPolicy:
    """What an infant does without exploring; the same observation has the same action."""

    network: BasePolicy
    scale: Mapping[str, np.ndarray]
    """Mean and deviation of what is put on one scale, by name."""
    clip: float
    scaled: Sequence[str]

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action on an observation, shape (n,); nothing is drawn by chance."""
        seen = {name: self._scale(name, part) if name in self.scaled else part for name, part in observation.items()}
        return self.network.predict(seen, deterministic=True)[0]

    def _scale(self, name: str, part: np.ndarray) -> np.ndarray:
        centred = (part - self.scale[f"{name}.mean"]) / self.scale[f"{name}.deviation"]
        return np.clip(centred, -self.clip, self.clip).astype(np.float32)


def pack_policy(agent: BaseAlgorithm, world: VecNormalize, settings: Settings, env: InfantEnv) -> bytes:
    """Return the file of what an agent has learned, for `load_policy`."""
    content = io.BytesIO()
    agent.save(content)
    about = {
        "policy": VERSION,
        "infant": env.manifest.name,
        "steps": agent.num_timesteps,
        "settings": settings.data(),
        "observes": observed(env),
        "commands": commanded(env),
    }
    scale, known = io.BytesIO(), dict[str, Any](statistics(world))
    np.savez(scale, **known)
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(ABOUT, json.dumps(about, indent=1))
        archive.writestr(SCALE, scale.getvalue())
    return content.getvalue()


def load_policy(path: str | Path) -> PolicyMaker:
    """Return what makes the policy in a file act on an environment, for `Run` and `evaluate`.

    Nothing that a file brings along is run. What is returned raises a PolicyError for an infant with other senses or
    other muscles than the one that was trained.

    Raises:
        PolicyError: If it is no policy of mimoc's.
    """
    path = Path(path).expanduser()
    if not path.is_file():
        raise PolicyError(f"{path}: there is no such file; name the policy.zip of a training")
    try:
        about, statistics_, network = _read(path)
        hyper = complete(about["settings"]["algo"], about["settings"]["hyper"])
    except DAMAGED:
        raise PolicyError(f"{path}: this is not a policy that mimoc trained, or it is damaged") from None
    return lambda env: _bind(path, about, hyper, statistics_, network, env)


def read_tensors(content: bytes) -> Any:
    """Return the tensors in a file of torch's; nothing else that it may hold is taken.

    Raises:
        ValueError: If it holds something else, or is damaged.
    """
    try:
        return torch.load(io.BytesIO(content), map_location="cpu", weights_only=True)
    except Exception as error:  # Torch does not say what it raises; on some damage, what it stumbles over.
        raise ValueError(f"no tensors: {error}") from None


def observed(env: InfantEnv) -> dict[str, Any]:
    """Return the shape and, of numbers, the meaning of each observation, by name."""
    return {name: {"shape": list(part.shape), "layout": _layout(env, name)} for name, part in _spaces(env).items()}


def commanded(env: InfantEnv) -> list[str]:
    """Return the names of what the action commands, in its order."""
    return [actuator.name for actuator in env.manifest.actuation.actuators if actuator.commanded]


def _read(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray], dict[str, torch.Tensor]]:
    with zipfile.ZipFile(path) as archive:
        about = json.loads(archive.read(ABOUT))
        if about["policy"] != VERSION:
            raise PolicyError(f"{path}: this policy is of another version of mimoc")
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
    """Return a policy that fits an environment."""
    differences = [
        *_differing_senses(about["observes"], observed(env)),
        *_differing_commands(about["commands"], commanded(env)),
    ]
    if differences:
        raise PolicyError(f"{path}: '{about['infant']}' was trained otherwise: {'; '.join(differences)}")
    network = make_policy(about["settings"]["algo"], hyper, env.observation_space, env.action_space)
    names = scaled(env.observation_space)
    try:
        network.load_state_dict(weights)
        means = {f"{name}.mean": known[f"{name}.mean"] for name in names}
        floor = hyper["observation_floor"]
        deviations = {f"{name}.deviation": np.sqrt(known[f"{name}.var"] + floor**2) for name in names}
    except (KeyError, RuntimeError):
        raise PolicyError(f"{path}: this is not a policy that mimoc trained, or it is damaged") from None
    network.set_training_mode(False)
    return TrainedPolicy(network, {**means, **deviations}, float(hyper["observation_clip"]), names)


def _differing_senses(trained: Mapping[str, Any], here: Mapping[str, Any]) -> list[str]:
    found = [f"it observed '{name}', which there is none of here" for name in trained.keys() - here.keys()]
    found += [f"it did not observe '{name}'" for name in here.keys() - trained.keys()]
    for name in sorted(trained.keys() & here.keys()):
        if (then := trained[name]["shape"]) != (now := here[name]["shape"]):
            found.append(f"'{name}' had the shape {_shape(then)}, here it has {_shape(now)}")
        else:
            found += _first_difference(f"'{name}'", trained[name]["layout"], here[name]["layout"])
    return sorted(found)


def _differing_commands(trained: Sequence[str], here: Sequence[str]) -> list[str]:
    if len(trained) != len(here):
        return [f"it commanded {len(trained)} actuators, here are {len(here)}"]
    return _first_difference("the action", trained, here)


def _first_difference(what: str, trained: Sequence[str], here: Sequence[str]) -> list[str]:
    for number, (then, now) in enumerate(zip(trained, here, strict=False)):
        if then != now:
            return [f"number {number} of {what} was {then}, here it is {now}"]
    return []


def _shape(sizes: Sequence[int]) -> str:
    return f"({', '.join(map(str, sizes))})"


def _spaces(env: InfantEnv) -> Mapping[str, Any]:
    space: Any = env.observation_space
    return space.spaces


def _layout(env: InfantEnv, name: str) -> list[str]:
    try:
        return list(env.layout(name))
    except UnknownNameError:  # A picture, or what a task adds.
        return []
