"""Trained policies and their files: what they say of themselves, their arrays, and networks that NumPy computes."""

import io
import json
import math
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError, PolicyError, UnknownNameError
from mimoc.bundle.io import FIRST_DATE, READABLE, UNIX, pack_arrays, unpack_arrays
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.runtime.infant import Infant

FloatArray = npt.NDArray[np.float32]

MAX_BYTES = 2**29
"""Largest size of an archive, and of all that is unpacked from it: 512 MB. A policy with all senses has some 10 MB."""
SMALL_BYTES = 2**24
"""Largest member that may be packed to any degree: descriptions, and statistics of a skin that nothing touched."""
MAX_RATIO = 20  # Largest ratio of a larger member to its packed size; weights of networks can hardly be packed.
MAX_MEMBERS = 1000


class Archive(zipfile.ZipFile):
    """A ZIP archive of which each member is unpacked when it is asked for."""

    def __init__(self, content: bytes):
        """Read the list of members; raise a ValueError or BadZipFile if it is no archive, or larger than any policy."""
        super().__init__(io.BytesIO(content))
        if len(self.infolist()) > MAX_MEMBERS:
            raise ValueError("an archive of too many members")
        self._left = MAX_BYTES

    def content(self, name: str) -> bytes:
        """Return the content of a member; raise a KeyError if there is none, a ValueError if it is too large."""
        member = self.getinfo(name)
        if member.file_size > max(SMALL_BYTES, MAX_RATIO * member.compress_size) or member.file_size > self._left:
            raise ValueError(f"{name} is larger than it can be")
        self._left -= member.file_size
        return self.read(member)


DAMAGED = (
    *(UnusableFileError, MimocError, zipfile.BadZipFile, zlib.error, NotImplementedError, EOFError, OSError),
    *(RuntimeError, RecursionError, KeyError, IndexError, ValueError, TypeError, AttributeError, OverflowError),
)
"""Exceptions that reading a file that is not a policy may raise."""


ABOUT, WEIGHTS = "mimoc.json", "weights.npz"  # The files in every policy archive: its description, and its arrays.
OF_AGENT, OF_NETWORK = 2, 3
"""Versions of files: of agents of Stable-Baselines3, and of one plain network. Those of version 1 had no arrays."""
NO_SUCH_FILE = "there is no such file; name the policy.zip of a training run"
NOT_A_POLICY = "not a policy trained by mimoc, or it is damaged"
OTHER_VERSION = "was saved by another version of mimoc; train it again"


@dataclass(frozen=True)
class PolicyFile:
    """A trained policy as its file has it; no code from the file is run."""

    path: Path
    about: dict[str, Any]  # Its description; see `interface_of`.
    archive: Archive

    def arrays(self, name: str) -> dict[str, np.ndarray]:
        """Return the arrays in a file of the archive; raise one of `DAMAGED` if there are none."""
        return unpack_arrays(self.archive.content(name))


def read_policy(path: str | Path) -> PolicyFile:
    """Read a policy's file; PolicyError if it is missing, damaged, or saved by another version of mimoc."""
    path = Path(path).expanduser()
    if not path.is_file():
        raise PolicyError(f"{path}: {NO_SUCH_FILE}")
    try:
        archive = Archive(read_regular_file(path, MAX_BYTES) or b"")
        about = json.loads(archive.content(ABOUT))
        version = about["policy"]
        if type(version) is int and version not in (OF_AGENT, OF_NETWORK):
            raise PolicyError(f"{path}: {OTHER_VERSION}")
        if type(version) is not int or not is_description(about):
            raise ValueError("it describes itself in a way that mimoc never does")
    except PolicyError:
        raise
    except DAMAGED:
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    return PolicyFile(path, about, archive)


def interface_of(env: Infant) -> dict[str, Any]:
    """Return shape and layout (empty for images) of each observation, and the actuators that the action commands."""
    spaces = spaces_of(env).items()
    observes = {name: {"shape": list(part.shape), "layout": _layout(env, name)} for name, part in spaces}
    return {"observes": observes, "commands": list(env.manifest.commands)}


def is_description(about: Any) -> bool:
    """Return whether data is what describes a policy in its file."""
    names = [about["infant"], *about["commands"]]
    for name, observation in about["observes"].items():
        names += [name, *observation["layout"]]
        if not all(type(size) is int for size in observation["shape"]):
            return False
    limit = about["settings"].get("steps_per_episode")
    if limit is not None and (type(limit) is not int or limit < 1):
        return False
    return all(isinstance(name, str) and name.isprintable() for name in names)


def check_fits(path: Path, about: Mapping[str, Any], interface: Mapping[str, Any]) -> None:
    """Raise a PolicyError if the policy in a file does not fit the interface of an infant."""
    if problems := differences(about, interface):
        raise PolicyError(f"{path}: trained for a different infant, '{about['infant']}': {'; '.join(problems)}")


def differences(about: Mapping[str, Any], interface: Mapping[str, Any]) -> list[str]:
    """Return how observations and actuators of the infant in training differ from those of another one."""
    trained, current = about["observes"], interface["observes"]
    result = [f"observation '{name}' is missing here" for name in trained.keys() - current.keys()]
    result += [f"observation '{name}' was not there in training" for name in current.keys() - trained.keys()]
    for name in trained.keys() & current.keys():
        if (then := tuple(trained[name]["shape"])) != (now := tuple(current[name]["shape"])):
            result.append(f"'{name}' had shape {then} in training and has {now} here")
        else:
            result += _first_difference(f"'{name}'", trained[name]["layout"], current[name]["layout"])
    commanded, commands = about["commands"], interface["commands"]
    if len(commanded) != len(commands):
        number = f"{len(commanded)} actuators in training and commands {len(commands)} here"
        return [*sorted(result), f"the action commanded {number}"]
    return [*sorted(result), *_first_difference("the action", commanded, commands)]


def spaces_of(env: Infant) -> Mapping[str, Any]:
    """Return the space of each observation of an infant, by name."""
    space: Any = env.observation_space
    return space.spaces


def _first_difference(what: str, trained: Sequence[str], current: Sequence[str]) -> list[str]:
    for number, (then, now) in enumerate(zip(trained, current, strict=False)):
        if then != now:
            return [f"element {number} of {what} was {then} in training and is {now} here"]
    return []


def _layout(env: Infant, name: str) -> list[str]:
    try:
        return list(env.layout(name))
    except UnknownNameError:  # An image, or an observation of the task.
        return []


@dataclass(frozen=True)
class TrainedPolicy:
    """A deterministic policy: the same observation always gives the same action, without exploration."""

    act: Callable[[dict[str, Any]], np.ndarray]
    """Returns the action for an observation, shape (n,); plain networks also for k of them, which have a leading axis,
    shape (k, n)."""
    steps_per_episode: int | None
    """Control steps after which an episode of its training was truncated; None if that is not known."""

    def __call__(self, generator: Any, observation: dict[str, Any]) -> np.ndarray:
        """Return the action for an observation, or raise a PolicyError if it is not finite; *generator* is not used."""
        action = self.act(observation)
        if not np.isfinite(action).all():
            raise PolicyError("this policy gives commands that are not finite; train it again")
        return action


MAX_LAYERS = 17


@dataclass(frozen=True)
class Network:
    """Layers of weights W and biases b after a normalisation of the observations x, in single precision.

    The input is h₀ = clip((x - mean) / deviation, -c, c), and hᵢ₊₁ = elu(Wᵢ hᵢ + bᵢ), where elu(z) is z above zero and
    exp(z) - 1 below; the last layer has no elu.
    """

    mean: FloatArray  # Shape (n,), in units of the observations.
    deviation: FloatArray  # Shape (n,), likewise.
    clip: float  # Absolute value c at which normalised observations are clipped.
    layers: Sequence[tuple[FloatArray, FloatArray]]
    """Weights, shape (outputs, inputs), and biases, shape (outputs,), of each layer."""

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """Return the outputs, shape (..., m), for observations side by side, shape (..., n)."""
        values = np.clip((inputs - self.mean) / self.deviation, -self.clip, self.clip)
        *hidden, (weights, biases) = self.layers
        for inner_weights, inner_biases in hidden:
            sums = values @ inner_weights.T + inner_biases
            values = np.where(sums > 0, sums, np.expm1(np.minimum(sums, 0)))
        return values @ weights.T + biases

    def arrays(self) -> dict[str, np.ndarray]:
        """Return all numbers, by their names in the file of a policy."""
        known: dict[str, np.ndarray] = {"mean": self.mean, "deviation": self.deviation, "clip": np.array(self.clip)}
        for number, (weights, biases) in enumerate(self.layers):
            known |= {f"{number}.weights": weights, f"{number}.biases": biases}
        return known

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, np.ndarray], inputs: int, outputs: int) -> "Network":
        """Return what `arrays` was called on; raise a Key- or ValueError if it is no network of these sizes."""
        count, rest = divmod(len(arrays) - 3, 2)
        if rest or not 1 <= count <= MAX_LAYERS:
            raise ValueError("a network of another number of layers")
        layers = [(_real(arrays[f"{i}.weights"]), _real(arrays[f"{i}.biases"])) for i in range(count)]
        mean, deviation, clip = (_real(arrays[name]) for name in ("mean", "deviation", "clip"))
        size = inputs
        for weights, biases in layers:
            if biases.ndim != 1 or weights.shape != (len(biases), size):
                raise ValueError("a layer of another size")
            size = len(biases)
        if size != outputs or not mean.shape == deviation.shape == (inputs,) or not (deviation > 0).all():
            raise ValueError("a network of another size")
        return cls(mean, deviation, float(clip), layers)


def pack_network(network: Network, about: Mapping[str, Any]) -> bytes:
    """Return the content of a policy file: the same bytes for the same network and description, on every system.

    *about* is the name of the `infant`, what it `observes` and `commands` (`interface_of`), and the `settings` of its
    training, of which `steps_per_episode` is read.
    """
    content = io.BytesIO()
    description = json.dumps({**about, "policy": OF_NETWORK}, indent=1, sort_keys=True)
    with zipfile.ZipFile(content, "w") as archive:
        for name, member in ((ABOUT, description.encode()), (WEIGHTS, pack_arrays(network.arrays()))):
            info = zipfile.ZipInfo(name, FIRST_DATE)
            info.create_system, info.external_attr = UNIX, READABLE
            archive.writestr(info, member)
    return content.getvalue()


def load_network(file: PolicyFile) -> PolicyMaker | None:
    """Return the policy in a file if it is one plain network; return None if it is one of Stable-Baselines3.

    It needs NumPy alone. The returned function raises a PolicyError for an infant that lacks what the trained infant
    observes, or has other actuators; what it observes besides is left alone.

    Raises:
        PolicyError: If it is damaged.
    """
    path, about = file.path, file.about
    if about["policy"] != OF_NETWORK:
        return None
    try:
        inputs = sum(math.prod(item["shape"]) for item in about["observes"].values())
        network = Network.of_arrays(file.arrays(WEIGHTS), inputs, len(about["commands"]))
    except DAMAGED:
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    return lambda env: _bind(path, about, network, env)


def _bind(path: Path, about: Mapping[str, Any], network: Network, env: Infant) -> Policy:
    """Return the policy for an environment; raise a PolicyError if it does not fit.

    An infant may sense more than the one in training: what that one sensed is picked by its names.
    """
    trained, interface = about["observes"], interface_of(env)
    observes = {name: item for name, item in interface["observes"].items() if name in trained}
    picks = {name: pick for name, item in observes.items() if (pick := _pick(trained[name], item)) is not None}
    check_fits(path, about, {**interface, "observes": {**observes, **{name: trained[name] for name in picks}}})
    shapes = {name: tuple(trained[name]["shape"]) for name in sorted(trained)}
    space: Any = env.action_space
    act = partial(_act, network, shapes, picks, (space.low, space.high))
    return TrainedPolicy(act, about["settings"].get("steps_per_episode"))


def _act(
    network: Network,
    shapes: Mapping[str, tuple[int, ...]],
    picks: Mapping[str, npt.NDArray[np.intp]],
    limits: tuple[np.ndarray, np.ndarray],
    observation: Mapping[str, Any],
) -> FloatArray:
    """Return the action of a network for what it observes: arrays of some shapes, or picked elements of them."""
    parts = []
    for name, shape in shapes.items():
        array = np.asarray(observation[name], np.float32)
        if name in picks:
            array = array[..., picks[name]]
        parts.append(array.reshape(*array.shape[: array.ndim - len(shape)], math.prod(shape)))
    return np.clip(network(np.concatenate(parts, axis=-1)), *limits).astype(np.float32)


def _pick(trained: Mapping[str, Any], sensed: Mapping[str, Any]) -> npt.NDArray[np.intp] | None:
    """Return where the elements that were sensed in training are among those sensed now; None if they are not."""
    wanted = trained["layout"]
    place = {name: place for place, name in enumerate(sensed["layout"])}
    if not wanted or len(place) < len(sensed["layout"]) or not place.keys() >= set(wanted):
        return None
    return np.array([place[name] for name in wanted])


def _real(array: np.ndarray) -> FloatArray:
    """Return an array in single precision; raise a ValueError if something in it is not finite."""
    if array.dtype.kind != "f" or not np.isfinite(array).all():
        raise ValueError("numbers that are not finite")
    return array.astype(np.float32)
