"""What all tasks have in common while they run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import gymnasium
import mujoco
import numpy as np

from mimoc.actuation.commands import command_range
from mimoc.actuation.spec import ActuationEntry
from mimoc.model_fields import ModelField
from mimoc.senses.sense import Observation


@dataclass(frozen=True, slots=True)
class Verdict:
    """What a task says of one control step.

    Example:
        >>> import mimoc
        >>> verdict = mimoc.Verdict({"height": 0.3, "effort": -0.1}, success=False)
        >>> round(sum(verdict.reward_terms.values()), 3)  # The reward.
        0.2
    """

    reward_terms: Mapping[str, float]
    """Terms of the reward, by name; `info` has them as `reward_terms`."""
    success: bool = False
    """Whether the goal is reached; `info` has it as `is_success`."""
    terminated: bool = False
    """Whether the episode ends with this step."""
    reward: float = field(init=False)
    """Sum of the terms."""

    def __post_init__(self) -> None:
        """Add up the terms."""
        object.__setattr__(self, "reward", sum(self.reward_terms.values(), 0.0))


NO_REWARD = Verdict({})


class Task:
    """What starts each episode and judges each control step; by itself, a world without a goal.

    To write a task, override `judge`, and of the rest what it needs:

        class HeadUp(Task):
            def bind(self, model, bundle):
                self.head = model.body(bundle.manifest.anatomy.head).id

            def judge(self, data, action, effort):
                height_m = float(data.xpos[self.head, 2])
                terms = {"height": height_m, "effort": -0.1 * effort()}
                return Verdict(terms, success=height_m > 0.4)

        env = mimoc.make("configs/nine_months.yaml", task=HeadUp(steps=500))

    In this order, `bind` is called once for each model (at the start, and again when the scene changes); `start` at
    each reset, when the infant is in its pose; `judge` after each control step; then `observe`. Look names up in
    `bind`, keep indices, and read arrays of *data* in `judge`. Draw random numbers only from the generator that `start`
    gets, so that a seed determines an episode. An environment is saved by `get_state` and restored by `set_state`:
    return in `state` what the task remembers within an episode, and in `model_fields` what it changes in the model.

    Example:
        >>> import mimoc
        >>> class Still(mimoc.Task):
        ...     def judge(self, data, action, effort):
        ...         return mimoc.Verdict({"speed": -float(abs(data.qvel).max())})
        >>> env = mimoc.make("nine_months.yaml", task=Still(steps=500))
        >>> _ = env.reset(seed=0)
        >>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        >>> reward == info["reward_terms"]["speed"] < 0
        True
    """

    def __init__(self, steps: int | None = None):
        """Make a task whose episodes are truncated after *steps* control steps.

        None is never; or, for one that is passed as an object, after those that the spec's task has, if any.
        """
        self.steps = steps

    def bind(self, model: mujoco.MjModel, bundle: Any) -> None:
        """Look up names in a model; tasks that a bundle names are bound when they are made instead.

        Args:
            model: The infant and its world.
            bundle: The `mimoc.Bundle` it comes from; `bundle.manifest` names the parts of the infant.
        """

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """Space of each array that it adds to the observation, by name."""
        return {}

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """What `start` and `judge` change in the model; all else in it must stay as it is."""
        return ()

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Start an episode.

        Args:
            data: A state that has just been reset, with all that follows from it (`mj_forward`). Whoever changes it
                calls `mj_forward` afterwards.
            generator: Source of all random numbers.
        """

    def observe(self) -> Observation:
        """Return what it adds to the observation, as fresh arrays within `spaces`."""
        return {}

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return the reward of the control step that has just been taken, and whether it ends the episode.

        Args:
            data: The state after it.
            action: The action, shape (n,), before it is clipped.
            effort: Returns the cost of the actuators' work in the last physics step (`InfantEnv.effort`).
        """
        return NO_REWARD

    @property
    def state(self) -> dict[str, Any]:
        """What it remembers within an episode; it can be set."""
        return {}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        pass


class SquaredCommands:
    """Sum of squared commands, which are clipped to their ranges first."""

    def __init__(self, entry: ActuationEntry):
        """Find the ranges of all commands of an action."""
        self._low, self._high = command_range(entry)

    def __call__(self, action: np.ndarray) -> float:
        """Return the sum for an action, shape (n,)."""
        commands = np.clip(action, self._low, self._high)
        return float(commands @ commands)
