"""How a training is done: all that, with the bundle, decides what is learned."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Self

from mimoc.errors import TrainingError
from mimoc.training.hyper import KNOBS, Number, complete


@dataclass(frozen=True, slots=True)
class Settings:
    """All choices of a training, none left open."""

    algo: str
    steps: int
    """Control steps to train for, those of all infants together; the last round of learning is done whole."""
    seed: int
    envs: int
    """How many infants act at a time."""
    checkpoint_every: int
    """Control steps from one checkpoint to the next, in whole rounds of learning."""
    hyper: Mapping[str, Number] = field(default_factory=dict)

    @classmethod
    def choose(
        cls, algo: str, steps: int, seed: int, envs: int, checkpoint_every: int, hyper: Mapping[str, Number]
    ) -> Self:
        """Return settings with every hyper-parameter in place.

        Raises:
            UnknownNameError: If there is no such algorithm or hyper-parameter.
            TrainingError: If a value is out of its range, or two do not go together.
        """
        for name, value in {"steps": steps, "envs": envs, "checkpoint_every": checkpoint_every}.items():
            if value < 1:
                raise TrainingError(f"{name}: {value} is too few; give 1 or more")
        if seed < 0:
            raise TrainingError(f"seed: {seed} is below zero; give a whole number from 0 on")
        chosen = cls(algo, steps, seed, envs, checkpoint_every, complete(algo, hyper))
        if algo == "ppo" and chosen.round_steps % chosen.hyper["batch_size"]:
            raise TrainingError(
                f"a round of {chosen.round_steps} steps (n_steps x envs) is not a whole number of batches of "
                f"{chosen.hyper['batch_size']}; choose a batch_size that divides it"
            )
        return chosen

    @property
    def round_steps(self) -> int:
        """Control steps of all infants between two rounds of learning."""
        return self.envs * int(self.hyper.get("n_steps", 1))

    def end_of_interval(self, begin: int) -> int:
        """Return the steps at which the interval that begins at some steps ends, in whole rounds."""
        wanted = min(begin + self.checkpoint_every, max(self.steps, begin + 1))
        return -(-wanted // self.round_steps) * self.round_steps

    def data(self) -> dict[str, Any]:
        """Return it for JSON."""
        return asdict(self)

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Self:
        """Return what `data` returned as it was."""
        return cls(**data)

    def differences(self, other: Self) -> list[str]:
        """Return what is not as in *other*, each as a phrase; it may have other steps."""
        mine, theirs = _flat(self), _flat(other)
        names = [name for name in mine.keys() | theirs.keys() if mine.get(name) != theirs.get(name)]
        return [f"{name} {theirs.get(name, 'nothing')}, not {mine.get(name, 'nothing')}" for name in sorted(names)]

    def options(self) -> list[str]:
        """Return the options of `mimoc train` that say the same."""
        told = ["--algo", self.algo, "--steps", str(self.steps), "--seed", str(self.seed), "--envs", str(self.envs)]
        told += ["--checkpoint-every", str(self.checkpoint_every)]
        defaults = KNOBS[self.algo]
        changed = {name: value for name, value in self.hyper.items() if value != defaults[name].default}
        return told + [part for name, value in changed.items() for part in ("--set", f"{name}={value!r}")]


def _flat(settings: Settings) -> dict[str, Any]:
    data = settings.data()
    del data["steps"]
    return {**data.pop("hyper"), **data}
