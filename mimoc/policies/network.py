"""Policies that are one plain network in a small file, computed by NumPy alone."""

import io
import json
import math
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import PolicyError
from mimoc.bundle.arrays import FIRST_DATE, READABLE, UNIX, pack_arrays
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.policies.policy_file import (
    ABOUT,
    DAMAGED,
    NOT_A_POLICY,
    OF_NETWORK,
    WEIGHTS,
    PolicyFile,
    check_fits,
    interface_of,
)
from mimoc.runtime.infant import Infant

FloatArray = npt.NDArray[np.float32]

MOST_LAYERS = 17


@dataclass(frozen=True)
class Network:
    """Layers of weights W and biases b after a normalisation of the observations x, in single precision.

    The input is h₀ = clip((x - mean) / deviation, -c, c), and hᵢ₊₁ = elu(Wᵢ hᵢ + bᵢ), where elu(z) is z above zero and
    exp(z) - 1 below; the last layer has no elu.
    """

    mean: FloatArray
    """Shape (n,), in units of the observations."""
    deviation: FloatArray
    """Shape (n,), likewise."""
    clip: float
    """Absolute value c at which normalised observations are clipped."""
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
        if rest or not 1 <= count <= MOST_LAYERS:
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


class NetworkPolicy:
    """A deterministic policy: the same observation always gives the same action, without exploration."""

    def __init__(
        self,
        network: Network,
        shapes: Mapping[str, tuple[int, ...]],
        picks: Mapping[str, npt.NDArray[np.intp]],
        limits: tuple[np.ndarray, np.ndarray],
        steps: Any,
    ):
        """Take a network, shapes of what it observes, which elements of these, limits of commands, and its steps."""
        self.network, self._shapes, self._limits = network, {name: shapes[name] for name in sorted(shapes)}, limits
        self._picks = picks
        self.steps_per_episode: int | None = steps
        """Control steps after which an episode of its training was truncated; None if that is not known."""

    def __call__(self, generator: Any, observation: Mapping[str, npt.NDArray[Any]]) -> FloatArray:
        """Return the action for an observation, shape (n,), or for k of them, which have a leading axis, (k, n).

        Raises a PolicyError if an action is not finite; *generator* is not used.
        """
        parts = []
        for name, shape in self._shapes.items():
            array = np.asarray(observation[name], np.float32)
            if name in self._picks:
                array = array[..., self._picks[name]]
            parts.append(array.reshape(*array.shape[: array.ndim - len(shape)], math.prod(shape)))
        action = np.clip(self.network(np.concatenate(parts, axis=-1)), *self._limits).astype(np.float32)
        if not np.isfinite(action).all():
            raise PolicyError("this policy gives commands that are not finite; train it again")
        return action


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
    shapes = {name: tuple(item["shape"]) for name, item in trained.items()}
    space: Any = env.action_space
    return NetworkPolicy(network, shapes, picks, (space.low, space.high), about["settings"].get("steps_per_episode"))


def _pick(trained: Mapping[str, Any], sensed: Mapping[str, Any]) -> npt.NDArray[np.intp] | None:
    """Return where the elements that were sensed in training are among those sensed now; None if they are not."""
    wanted, place = trained["layout"], {name: place for place, name in enumerate(sensed["layout"])}
    if not wanted or len(place) < len(sensed["layout"]) or not place.keys() >= set(wanted):
        return None
    return np.array([place[name] for name in wanted])


def _real(array: np.ndarray) -> FloatArray:
    """Return an array in single precision; raise a ValueError if something in it is not finite."""
    if array.dtype.kind != "f" or not np.isfinite(array).all():
        raise ValueError("numbers that are not finite")
    return array.astype(np.float32)
