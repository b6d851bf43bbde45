"""Settings and hyperparameters of a training run, which with the bundle determine its result; what learning needs."""

import json
import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from hashlib import sha256
from types import MappingProxyType
from typing import Any, Self, cast

import numpy as np
from gymnasium.spaces import Dict

from mimoc.base.errors import TrainingError, UnknownNameError
from mimoc.base.units import ms_to_s
from mimoc.runtime.env import InfantEnv

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

CPU = "cpu"  # The device of infants in MuJoCo itself; all others are those of MuJoCo Warp, where rsl_rl learns.
DEVICE_HYPERPARAMETERS: Mapping[str, Mapping[str, Hyperparameter]] = {
    "ppo": {
        **{name: item for name, item in HYPERPARAMETERS["ppo"].items() if name != "batch_size"},
        "init_std": Hyperparameter(0.6, 1e-3, 10.0),
        "max_grad_norm": Hyperparameter(1.0, 1e-3, 1e6),
        "mini_batches": Hyperparameter(4, 1, 2**20),
        "n_epochs": Hyperparameter(5, 1, 1000),
        "n_steps": Hyperparameter(32, 2, 2**20),
        "target_kl": Hyperparameter(0.03, 1e-6, 1e6),
        "width": Hyperparameter(256, 1, 2**14),
    }
}
"""Likewise on a device, for thousands of infants. The learning rate stays as it is: with the many commands of an
infant, one that follows the KL divergence is unstable. An update has `n_epochs` passes over the rollout in
`mini_batches` parts, and ends early where that divergence exceeds `target_kl`. Gradients are clipped at
`max_grad_norm`. Commands are drawn with a deviation of `init_std` at first."""


def hyperparameters_of(algo: str, device: str = CPU) -> Mapping[str, Hyperparameter]:
    """Return the hyperparameters of an algorithm, by name."""
    tables = HYPERPARAMETERS if device == CPU else DEVICE_HYPERPARAMETERS
    if algo not in tables:
        raise UnknownNameError("learning algorithm" + ("" if device == CPU else " on a device"), algo, tables)
    return tables[algo]


def complete(algo: str, chosen: Mapping[str, Number], device: str = CPU) -> dict[str, Number]:
    """Return all hyperparameters of an algorithm, with defaults for those that were not chosen."""
    known = hyperparameters_of(algo, device)
    for name in chosen.keys() - known.keys():
        raise UnknownNameError(f"hyperparameter of {algo}", name, known)
    values: dict[str, Number] = {}
    for name, item in sorted(known.items()):
        value = chosen.get(name, item.default)
        whole = isinstance(item.default, int)
        if not item.low <= value <= item.high or (whole and value != int(value)):
            kind = "an integer" if whole else "a number"
            raise TrainingError(f"{name}: expected {kind} from {item.low:g} to {item.high:g}, got {value:g}")
        values[name] = int(value) if whole else float(value)
    return values


def parse(algo: str, assignments: list[str], device: str = CPU) -> dict[str, Number]:
    """Return the hyperparameters set by assignments such as `learning_rate=1e-3`."""
    chosen: dict[str, Number] = {}
    for text in assignments:
        name, _, value = text.partition("=")
        try:
            chosen[name] = float(value)
        except ValueError:
            raise TrainingError(f"'{text}' is not an assignment; write NAME=NUMBER, such as gamma=0.99") from None
    completed = complete(algo, chosen, device)
    return {name: completed[name] for name in chosen}


CHECKPOINT_EVERY = 20_480
DEVICE_EPISODES = 4
"""Episodes of each infant on a device between checkpoints, of which the first is cut at a random time."""


@dataclass(frozen=True, slots=True)
class TrainingSettings:
    """All settings of a training run, with defaults filled in."""

    algo: str
    steps: int  # Control steps to train for, summed over all environments; the last rollout is completed.
    seed: int
    envs: int  # Number of parallel environments.
    checkpoint_every: int  # Control steps between checkpoints, rounded up to whole rollouts.
    hyper: Mapping[str, Number] = field(default_factory=dict)
    custom: Mapping[str, str] = field(default_factory=dict)
    """Classes of the objects that a script passed, as `module:Class`, by `task` or `senses.<name>`."""
    growth: Mapping[str, Any] = field(default_factory=dict)
    """If the infant grows: its `schedule`, its youngest and oldest age as `grow`, and `grow_steps`, the control steps
    that growth takes, summed over all environments."""
    steps_per_episode: int | None = None
    """Control steps after which an episode is truncated; None in runs of earlier versions, which do not say it."""
    device: str = CPU  # Where the infants live, as for `mimoc.make_vec`.

    @classmethod
    def choose(
        cls,
        algo: str,
        steps: int,
        seed: int,
        envs: int,
        checkpoint_every: int | None,
        hyper: Mapping[str, Number],
        custom: Mapping[str, str] = MappingProxyType({}),
        growth: Mapping[str, Any] = MappingProxyType({}),
        steps_per_episode: int | None = None,
        device: str = CPU,
    ) -> Self:
        """Return settings with defaults for the hyperparameters that are not given.

        Without `checkpoint_every`, it is CHECKPOINT_EVERY, or as many control steps as one whole episode of each
        environment if these are more (on a device, DEVICE_EPISODES): environments are reset at each checkpoint, and no
        episode would ever end.
        """
        counts = {"steps": steps, "envs": envs, "checkpoint_every": checkpoint_every}
        for name, value in {**counts, "steps_per_episode": steps_per_episode}.items():
            if value is not None and value < 1:
                raise TrainingError(f"{name}: expected at least 1, got {value}")
        if seed < 0:
            raise TrainingError(f"seed: expected a non-negative integer, got {seed}")
        episodes = 1 if device == CPU else DEVICE_EPISODES
        usual = max(CHECKPOINT_EVERY, episodes * envs * (steps_per_episode or 0))
        every = usual if checkpoint_every is None else checkpoint_every
        known = complete(algo, hyper, device), dict(custom), dict(growth), steps_per_episode, device
        chosen = cls(algo, steps, seed, envs, every, *known)
        if device != CPU:
            if chosen.rollout_steps % (parts := chosen.hyper["mini_batches"]):
                raise TrainingError(
                    f"a rollout of {chosen.rollout_steps} steps (n_steps x envs) has no {parts} equal parts; choose "
                    "mini_batches that divide it"
                )
        elif algo == "ppo" and chosen.rollout_steps % chosen.hyper["batch_size"]:
            raise TrainingError(
                f"a rollout of {chosen.rollout_steps} steps (n_steps x envs) is not a multiple of batch_size "
                f"{chosen.hyper['batch_size']}; choose a batch_size that divides it"
            )
        return chosen

    @property
    def rollout_steps(self) -> int:
        """Control steps of a rollout, after which the policy is updated, summed over all environments."""
        return self.envs * int(self.hyper.get("n_steps", 1))

    def end_of_interval(self, start_steps: int) -> int:
        """Return the number of steps at the end of the interval that starts at *start_steps*, in whole rollouts."""
        wanted = min(start_steps + self.checkpoint_every, max(self.steps, start_steps + 1))
        return -(-wanted // self.rollout_steps) * self.rollout_steps

    def interval_seed(self, start_steps: int) -> int:
        """Return the seed of the training interval that starts after *start_steps* control steps."""
        return int(np.random.SeedSequence([self.seed, start_steps]).generate_state(1)[0]) // 2

    def data(self) -> dict[str, Any]:
        """Return the settings as a dictionary for JSON; the device only if it is not the CPU."""
        data = asdict(self)
        return data if self.device != CPU else {name: value for name, value in data.items() if name != "device"}

    def digest(self) -> str:
        """Return a name for all trainings with these settings, however long they are: their episodes are the same."""
        data = {name: value for name, value in self.data().items() if name != "steps"}
        return sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:16]

    def differences(self, other: Self) -> list[str]:
        """Return the settings that differ from *other*, each as a phrase; `steps` may differ."""
        mine, theirs = _flat(self), _flat(other)
        if other.steps_per_episode is None:
            del mine["steps_per_episode"], theirs["steps_per_episode"]
        names = [name for name in mine.keys() | theirs.keys() if mine.get(name) != theirs.get(name)]
        return [f"{name} {theirs.get(name, 'unset')}, not {mine.get(name, 'unset')}" for name in sorted(names)]

    def options(self) -> list[str]:
        """Return the options of `mimoc train` that give these settings."""
        options = ["--algo", self.algo, "--steps", str(self.steps), "--seed", str(self.seed), "--envs", str(self.envs)]
        options += ["--checkpoint-every", str(self.checkpoint_every)]
        options += ["--device", self.device] if self.device != CPU else []
        options += ["--steps-per-episode", str(self.steps_per_episode)] if self.steps_per_episode else []
        options += ["--task", self.custom["task"]] if "task" in self.custom else []
        options += [part for name, value in self.growth.items() for part in (f"--{name.replace('_', '-')}", str(value))]
        defaults = hyperparameters_of(self.algo, self.device)
        changed = {name: value for name, value in self.hyper.items() if value != defaults[name].default}
        return options + [part for name, value in changed.items() for part in ("--set", f"{name}={value!r}")]


def _flat(settings: TrainingSettings) -> dict[str, Any]:
    data = settings.data()
    del data["steps"]
    return {**data.pop("hyper"), **data.pop("custom"), **data.pop("growth"), **data, "device": settings.device}


def check_envs(envs: int, device: str) -> None:
    """Raise a TrainingError if there are more infants than anyone has on the CPU, where they need memory and time."""
    if device == CPU and envs > MAX_ENVS_ON_CPU:
        raise TrainingError(
            f"envs: expected at most {MAX_ENVS_ON_CPU} on the CPU, got {envs}; give fewer, or a --device"
        )


MAX_ENVS_ON_CPU = 1024


MIN_IMAGE_PX = 36  # Smallest image that Stable-Baselines3's convolutional network accepts.
STEPS_PER_EPISODE = 500
"""Control steps of an episode that neither the caller nor the task limits: 5 s, with control steps of 10 ms."""
NOTHING = "nothing"  # The observation of an infant without senses.


def check_learnable(infant: InfantEnv) -> None:
    """Check that an infant observes something to learn from, in images that are large enough, and can act."""
    manifest = infant.manifest
    space = cast("Dict", infant.observation_space)
    if not manifest.actuation.commands:
        raise TrainingError("this infant has no commanded actuators to train; name some in actuation.regions")
    if [*space] == [NOTHING]:
        raise TrainingError(
            f"'{manifest.name}' observes nothing to learn from; give its spec a sense, such as senses: "
            "{proprioception: {}}"
        )
    vision = manifest.senses.vision
    if vision and min(vision.width_px, vision.height_px) < MIN_IMAGE_PX:
        size = f"{vision.width_px} x {vision.height_px}"
        raise TrainingError(f"images of {size} px are too small to learn from; give at least {MIN_IMAGE_PX} px")


def episode_limit(infant: InfantEnv, chosen: int | None) -> int:
    """Return after how many control steps the episodes of a training end: as was chosen, or as the task says.

    If neither says it, it is STEPS_PER_EPISODE, with a warning.
    """
    of_task = infant.max_steps
    if of_task is None and chosen is None:
        duration_s = ms_to_s(STEPS_PER_EPISODE * infant.manifest.step_ms)
        warnings.warn(
            f"the task of '{infant.manifest.name}' does not limit its episodes: this training ends them after "
            f"{STEPS_PER_EPISODE} control steps ({duration_s:g} s); choose another number with steps_per_episode",
            stacklevel=3,
        )
        return STEPS_PER_EPISODE
    if of_task is not None and chosen is not None and chosen > of_task:
        raise TrainingError(
            f"steps_per_episode: the task ends episodes after {of_task} control steps; give at most as many, or change "
            "the steps of the task"
        )
    return chosen or of_task or STEPS_PER_EPISODE
