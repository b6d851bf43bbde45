"""What all tasks have in common."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import gymnasium
import mujoco
import numpy as np

from mimoc.actuation.commands import command_range
from mimoc.actuation.spec import ActuationEntry
from mimoc.senses.sense import Observation


@dataclass(frozen=True, slots=True)
class Verdict:
    """What a task says of one control step."""

    terms: Mapping[str, float]
    """What the reward is made of, by name; it is their sum."""
    success: bool = False
    """Whether the goal is reached."""
    ends: bool = False
    """Whether the episode ends with this step."""
    reward: float = field(init=False)
    """What the step earns."""

    def __post_init__(self) -> None:
        """Add up what it earns."""
        object.__setattr__(self, "reward", sum(self.terms.values(), 0.0))


NOTHING_EARNED = Verdict({})


class Task:
    """What sets out each episode and judges each control step; by itself, a world without a goal."""

    def __init__(self, steps: int | None):
        """Make a task whose episodes are cut off after so many control steps; None is never."""
        self.steps = steps

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """What it adds to the observation."""
        return {}

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Set out an episode in a state that has just been reset, all of it computed; leave it so."""

    def observe(self) -> Observation:
        """Return what it adds to the observation, as fresh arrays."""
        return {}

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return what it says of the control step that has just been taken.

        Args:
            data: The state after it.
            action: What was commanded, shape (n,).
            effort: Returns what the actuators' work costs now (`InfantEnv.effort`).
        """
        return NOTHING_EARNED

    @property
    def state(self) -> dict[str, Any]:
        """What it must remember within an episode."""
        return {}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        pass


class SquaredCommands:
    """What commands cost: the sum of their squares, where those beyond their range count as they are clipped."""

    def __init__(self, entry: ActuationEntry):
        """Find the ranges of all commands of an action."""
        self._low, self._high = command_range(entry)

    def __call__(self, action: np.ndarray) -> float:
        """Return the sum for an action, shape (n,)."""
        commands = np.clip(action, self._low, self._high)
        return float(commands @ commands)
