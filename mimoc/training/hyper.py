"""What each algorithm can be told: hyper-parameters, their defaults and ranges."""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.errors import TrainingError, UnknownNameError

Number = int | float


@dataclass(frozen=True, slots=True)
class Knob:
    """One hyper-parameter; it is a whole number if its default is."""

    default: Number
    low: Number
    high: Number


_COMMON = {
    "gamma": Knob(0.98, 0.0, 1.0),
    "learning_rate": Knob(3e-4, 1e-8, 1.0),
    "batch_size": Knob(256, 2, 2**20),
    "layers": Knob(2, 1, 16),
    "width": Knob(64, 1, 2**14),
    "observation_clip": Knob(5.0, 0.1, 1e6),
    "observation_floor": Knob(0.01, 1e-6, 1e6),
}

KNOBS: Mapping[str, Mapping[str, Knob]] = {
    "ppo": {
        **_COMMON,
        "clip_range": Knob(0.2, 1e-3, 10.0),
        "ent_coef": Knob(0.0, 0.0, 10.0),
        "gae_lambda": Knob(0.95, 0.0, 1.0),
        "n_epochs": Knob(10, 1, 1000),
        "n_steps": Knob(256, 2, 2**20),
    },
    "sac": {
        **_COMMON,
        "buffer_size": Knob(100_000, 100, 10**8),
        "gradient_steps": Knob(1, 1, 1000),
        "learning_starts": Knob(2000, 1, 10**8),
        "tau": Knob(0.005, 1e-6, 1.0),
        "width": Knob(256, 1, 2**14),
    },
}
"""By algorithm. Those of learning are called as Stable-Baselines3 calls them; the networks have `layers` of `width`;
an observation is divided by its standard deviation, or by `observation_floor` (in its own unit) if it varies less, so
that the trembling of joints that are held still is not taken for news, and cut at `observation_clip`."""


def complete(algo: str, chosen: Mapping[str, Number]) -> dict[str, Number]:
    """Return all hyper-parameters of an algorithm, those that were not chosen at their defaults.

    Raises:
        UnknownNameError: If there is no such algorithm, or no such hyper-parameter of it.
        TrainingError: If one is out of its range.
    """
    if algo not in KNOBS:
        raise UnknownNameError("learning algorithm", algo, KNOBS)
    knobs = KNOBS[algo]
    for name in chosen.keys() - knobs.keys():
        raise UnknownNameError(f"hyper-parameter of {algo}", name, knobs)
    return {name: _within(name, chosen.get(name, knob.default), knob) for name, knob in sorted(knobs.items())}


def read(algo: str, assignments: list[str]) -> dict[str, Number]:
    """Return the hyper-parameters that texts such as `learning_rate=1e-3` choose.

    Raises:
        UnknownNameError: If there is no such algorithm, or no such hyper-parameter of it.
        TrainingError: If a text is no such assignment, or a value is out of its range.
    """
    found: dict[str, Number] = {}
    for text in assignments:
        name, _, value = text.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise TrainingError(f"'{text}' sets nothing; write a name and a number, such as gamma=0.99") from None
    completed = complete(algo, found)
    return {name: completed[name] for name in found}


def _within(name: str, value: Number, knob: Knob) -> Number:
    whole = isinstance(knob.default, int)
    if not knob.low <= value <= knob.high or (whole and value != int(value)):
        kind = "a whole number" if whole else "a number"
        raise TrainingError(f"{name}: {value:g} will not do; give {kind} from {knob.low:g} to {knob.high:g}")
    return int(value) if whole else float(value)
