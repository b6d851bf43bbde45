"""Hyperparameters of the learning algorithms, with their defaults and ranges."""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.errors import TrainingError, UnknownNameError

Number = int | float


@dataclass(frozen=True, slots=True)
class Hyperparameter:
    """A hyperparameter's default and range; its values are integers if its default is one."""

    default: Number
    low: Number
    high: Number


_COMMON = {
    "gamma": Hyperparameter(0.98, 0.0, 1.0),
    "learning_rate": Hyperparameter(3e-4, 1e-8, 1.0),
    "batch_size": Hyperparameter(256, 2, 2**20),
    "layers": Hyperparameter(2, 1, 16),
    "width": Hyperparameter(64, 1, 2**14),
    "observation_clip": Hyperparameter(5.0, 0.1, 1e6),
    "observation_floor": Hyperparameter(0.01, 1e-6, 1e6),
}

HYPERPARAMETERS: Mapping[str, Mapping[str, Hyperparameter]] = {
    "ppo": {
        **_COMMON,
        "clip_range": Hyperparameter(0.2, 1e-3, 10.0),
        "ent_coef": Hyperparameter(0.0, 0.0, 10.0),
        "gae_lambda": Hyperparameter(0.95, 0.0, 1.0),
        "n_epochs": Hyperparameter(10, 1, 1000),
        "n_steps": Hyperparameter(256, 2, 2**20),
    },
    "sac": {
        **_COMMON,
        "buffer_size": Hyperparameter(100_000, 100, 10**8),
        "gradient_steps": Hyperparameter(1, 1, 1000),
        "learning_starts": Hyperparameter(2000, 1, 10**8),
        "tau": Hyperparameter(0.005, 1e-6, 1.0),
        "width": Hyperparameter(256, 1, 2**14),
    },
}
"""Hyperparameters by algorithm. Those of the algorithm itself have Stable-Baselines3's names. Networks have `layers`
hidden layers of `width` units. Observations are normalised: divided by their standard deviation, or by
`observation_floor` (in the observation's unit) if they vary less, so that tremor of joints at rest is not amplified,
and clipped at `observation_clip`."""


def complete(algo: str, chosen: Mapping[str, Number]) -> dict[str, Number]:
    """Return all hyperparameters of an algorithm, with defaults for those that were not chosen.

    Raises:
        UnknownNameError: If there is no such algorithm, or it has no such hyperparameter.
        TrainingError: If a value is out of range.
    """
    if algo not in HYPERPARAMETERS:
        raise UnknownNameError("learning algorithm", algo, HYPERPARAMETERS)
    known = HYPERPARAMETERS[algo]
    for name in chosen.keys() - known.keys():
        raise UnknownNameError(f"hyperparameter of {algo}", name, known)
    return {name: _checked(name, chosen.get(name, one.default), one) for name, one in sorted(known.items())}


def parse(algo: str, assignments: list[str]) -> dict[str, Number]:
    """Return the hyperparameters set by assignments such as `learning_rate=1e-3`.

    Raises:
        UnknownNameError: If there is no such algorithm, or it has no such hyperparameter.
        TrainingError: If a text is not an assignment, or a value is out of range.
    """
    chosen: dict[str, Number] = {}
    for text in assignments:
        name, _, value = text.partition("=")
        try:
            chosen[name] = float(value)
        except ValueError:
            raise TrainingError(f"'{text}' is not an assignment; write NAME=NUMBER, such as gamma=0.99") from None
    completed = complete(algo, chosen)
    return {name: completed[name] for name in chosen}


def _checked(name: str, value: Number, known: Hyperparameter) -> Number:
    whole = isinstance(known.default, int)
    if not known.low <= value <= known.high or (whole and value != int(value)):
        kind = "an integer" if whole else "a number"
        raise TrainingError(f"{name}: expected {kind} from {known.low:g} to {known.high:g}, got {value:g}")
    return int(value) if whole else float(value)
