"""Trained policies: self-contained files that are loaded without running any code from them.

Of such archives nothing is unpacked that is larger than it can be.
"""

import io
import json
import math
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.base.errors import MimocError, PolicyError, UnknownNameError
from mimoc.bundle.arrays import pack_arrays, unpack_arrays
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation
from mimoc.training.agents import make_policy, set_weights, weights_of
from mimoc.training.settings import TrainingSettings, complete
from mimoc.training.vector_env import normalized_names, statistics

MOST_BYTES = 2**29
"""Of an archive, and of all that is unpacked of it; 512 MB. Policies of all senses and both eyes have some 10 MB."""
SMALL_BYTES = 2**24
"""Of a member that may be packed to any degree: descriptions, and statistics of a skin that nothing has touched."""
MOST_RATIO = 20
"""Of a larger member to its packed size: weights of networks are noise, which cannot be packed."""
MOST_MEMBERS = 1000


class Archive(zipfile.ZipFile):
    """A ZIP archive of which each member is unpacked when it is asked for."""

    def __init__(self, content: bytes):
        """Read the list of members; raise a ValueError or BadZipFile if it is no archive, or larger than any policy."""
        super().__init__(io.BytesIO(content))
        if len(self.infolist()) > MOST_MEMBERS:
            raise ValueError("an archive of too many members")
        self._left = MOST_BYTES

    def content(self, name: str) -> bytes:
        """Return the content of a member; raise a KeyError if there is none, a ValueError if it is too large."""
        member = self.getinfo(name)
        if member.file_size > max(SMALL_BYTES, MOST_RATIO * member.compress_size) or member.file_size > self._left:
            raise ValueError(f"{name} is larger than it can be")
        self._left -= member.file_size
        return self.read(member)


ABOUT, SCALE, WEIGHTS = "mimoc.json", "scale.npz", "weights.npz"
"""The files in a policy archive that mimoc reads: description, statistics of the observations, and weights. The others
are for Stable-Baselines3, whose `load` accepts the archive too and unpickles them; mimoc never does."""
OF_TORCH = "policy.pth"
"""The weights, for Stable-Baselines3."""
VERSION = 2
"""Of what mimoc reads; policies of version 1 had no `weights.npz`."""
DAMAGED = (
    *(UnusableFileError, MimocError, zipfile.BadZipFile, zlib.error, NotImplementedError, EOFError, OSError),
    *(RuntimeError, RecursionError, KeyError, IndexError, ValueError, TypeError, AttributeError, OverflowError),
)
"""Exceptions that reading a file that is not a policy may raise."""


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


def pack_policy(agent: BaseAlgorithm, vector_env: VecNormalize, settings: TrainingSettings, env: InfantEnv) -> bytes:
    """Return the content of an agent's policy file, for `load_policy`."""
    content = io.BytesIO()
    agent.save(content)
    about = {
        "policy": VERSION,
        "infant": env.manifest.name,
        "steps": agent.num_timesteps,
        "settings": settings.data(),
        **_interface(env),
    }
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(ABOUT, json.dumps(about, indent=1))
        archive.writestr(SCALE, pack_arrays(statistics(vector_env)))
        archive.writestr(WEIGHTS, pack_arrays(weights_of(agent.policy)), zipfile.ZIP_STORED)
    return content.getvalue()


def load_policy(path: str | Path) -> PolicyMaker:
    """Load a trained policy; return a function that binds it to an environment, for `Run` and `evaluate`.

    Loading a policy runs no code from its file. The returned function raises a PolicyError for an infant whose
    observations or actuators differ from those of the trained infant.

    Raises:
        PolicyError: If the file is not a policy trained by mimoc.

    Example:
        >>> import mimoc
        >>> policy = mimoc.load_policy("runs/reach/policy.zip")
        >>> env = mimoc.make("reach.yaml", max_episode_steps=5)
        >>> len(mimoc.evaluate(env, policy, episodes=1))
        1
    """
    path = Path(path).expanduser()
    if not path.is_file():
        raise PolicyError(f"{path}: there is no such file; name the policy.zip of a training run")
    try:
        about, statistics_, network = _read(path)
        hyper = complete(about["settings"]["algo"], about["settings"]["hyper"])
    except _OtherVersionError:
        raise PolicyError(f"{path}: was saved by another version of mimoc; train it again") from None
    except DAMAGED:
        raise PolicyError(f"{path}: {_DAMAGED}") from None
    return lambda env: _bind(path, about, hyper, statistics_, network, env)


def _interface(env: InfantEnv) -> dict[str, Any]:
    """Return shape and layout (empty for images) of each observation, and the actuators that the action commands."""
    spaces = _spaces(env).items()
    observes = {name: {"shape": list(part.shape), "layout": _layout(env, name)} for name, part in spaces}
    commands = [actuator.name for actuator in env.manifest.actuation.actuators if actuator.commanded]
    return {"observes": observes, "commands": commands}


def _read(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return description, statistics and weights in a file; raise one of `DAMAGED` if it is no policy."""
    content = read_regular_file(path, MOST_BYTES)
    if content is None:
        raise ValueError("it cannot be read")
    archive = Archive(content)
    about = json.loads(archive.content(ABOUT))
    if (saved_by := about["policy"]) != VERSION:
        raise _OtherVersionError if type(saved_by) is int else ValueError
    known, weights = unpack_arrays(archive.content(SCALE)), unpack_arrays(archive.content(WEIGHTS))
    is_finite = all(np.isfinite(array).all() for array in (*known.values(), *weights.values()))
    if not _is_description(about) or not is_finite:
        raise ValueError("it describes itself in a way that mimoc never does")
    return about, known, weights


def _is_description(about: Any) -> bool:
    """Return whether data is what `pack_policy` writes into `mimoc.json`."""
    names = [about["infant"], *about["commands"]]
    for name, observation in about["observes"].items():
        names += [name, *observation["layout"]]
        if not all(type(size) is int for size in observation["shape"]):
            return False
    limit = about["settings"].get("steps_per_episode")
    if limit is not None and (type(limit) is not int or limit < 1):
        return False
    return all(isinstance(name, str) and name.isprintable() for name in names)


def _bind(
    path: Path,
    about: dict[str, Any],
    hyper: Mapping[str, Any],
    known: Mapping[str, np.ndarray],
    weights: Mapping[str, np.ndarray],
    env: InfantEnv,
) -> Policy:
    """Return the policy for an environment; raise a PolicyError if it does not fit."""
    differences = _differences(about, _interface(env))
    if differences:
        raise PolicyError(f"{path}: trained for a different infant, '{about['infant']}': {'; '.join(differences)}")
    scale = dict[str, tuple[np.ndarray, np.ndarray]]()
    try:
        if not _has_room(hyper, weights, env):
            raise ValueError("fewer weights than its layers have")
        network = make_policy(about["settings"]["algo"], hyper, env.observation_space, env.action_space)
        set_weights(network, weights)
        for name in normalized_names(env.observation_space):
            mean, variance = known[f"{name}.mean"], np.maximum(known[f"{name}.var"], 0.0)
            if not mean.shape == variance.shape == _spaces(env)[name].shape:
                raise ValueError(f"the statistics of '{name}' are of another shape")
            scale[name] = mean, np.sqrt(variance + hyper["observation_floor"] ** 2)
    except (KeyError, RuntimeError, ValueError, TypeError, AttributeError):
        raise PolicyError(f"{path}: {_DAMAGED}") from None
    network.set_training_mode(False)
    limit = about["settings"].get("steps_per_episode")
    return TrainedPolicy(network, scale, float(hyper["observation_clip"]), limit)


class _OtherVersionError(Exception):
    """A policy was saved by another version of mimoc."""


_DAMAGED = "not a policy trained by mimoc, or it is damaged"


def _has_room(hyper: Mapping[str, Any], weights: Mapping[str, np.ndarray], env: InfantEnv) -> bool:
    """Return whether there are as many weights as the layers of a network have at least, before it is made."""
    width, layers = int(hyper["width"]), int(hyper["layers"])
    inputs = sum(math.prod(space.shape) for space in _spaces(env).values() if len(space.shape) == 1)
    return width * (inputs + width * (layers - 1)) <= sum(array.size for array in weights.values())


def _differences(about: Mapping[str, Any], interface: Mapping[str, Any]) -> list[str]:
    """Return how observations and actuators of the infant in training differ from those of another one."""
    trained, current = about["observes"], interface["observes"]
    differences = [f"observation '{name}' is missing here" for name in trained.keys() - current.keys()]
    differences += [f"observation '{name}' was not there in training" for name in current.keys() - trained.keys()]
    for name in trained.keys() & current.keys():
        if (then := tuple(trained[name]["shape"])) != (now := tuple(current[name]["shape"])):
            differences.append(f"'{name}' had shape {then} in training and has {now} here")
        else:
            differences += _first_difference(f"'{name}'", trained[name]["layout"], current[name]["layout"])
    commanded, commands = about["commands"], interface["commands"]
    if len(commanded) != len(commands):
        number = f"{len(commanded)} actuators in training and commands {len(commands)} here"
        return [*sorted(differences), f"the action commanded {number}"]
    return [*sorted(differences), *_first_difference("the action", commanded, commands)]


def _first_difference(what: str, trained: Sequence[str], current: Sequence[str]) -> list[str]:
    for number, (then, now) in enumerate(zip(trained, current, strict=False)):
        if then != now:
            return [f"element {number} of {what} was {then} in training and is {now} here"]
    return []


def _spaces(env: InfantEnv) -> Mapping[str, Any]:
    space: Any = env.observation_space
    return space.spaces


def _layout(env: InfantEnv, name: str) -> list[str]:
    try:
        return list(env.layout(name))
    except UnknownNameError:  # An image, or an observation of the task.
        return []
