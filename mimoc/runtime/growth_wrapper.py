"""An environment whose infant grows with the number of its steps."""

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np

from mimoc.base.classes import described
from mimoc.base.errors import MimocError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import AGE, OLDEST_MONTHS
from mimoc.runtime.growth_schedule import growth_schedule


class GrowthWrapper(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Lets an infant grow over its control steps, in the midst of episodes and across them.

    Spaces stay as they are, and `info["age_months"]` says how old the infant is.

    Example:
        >>> import mimoc
        >>> env = mimoc.GrowthWrapper(mimoc.make("reach.yaml"), "grown", ages_months=(6, 12), steps=1000)
        >>> observation, info = env.reset(seed=0)
        >>> info["age_months"]
        6.0
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        schedule: str | Callable[[int], float] = "grown",
        *,
        ages_months: Sequence[float] = (0, OLDEST_MONTHS),
        steps: int = 100_000,
        seed: int | np.random.Generator = 0,
    ):
        """Wrap an environment.

        Args:
            env: The environment of an infant, as `mimoc.make` returns it.
            schedule: `grown`, `adult`, `reversed` or `shuffled`; or a function from the number of control steps taken
                so far to the age in months, such as `growth_schedule` returns.
            ages_months: For a word, the youngest and the oldest age.
            steps: For a word, the control steps that growth takes.
            seed: Of `shuffled`, or the generator that draws the order.

        Raises:
            UnknownNameError: If there is no such schedule.
            MimocError: If it is not the environment of an infant, or these are no ages or no number of steps.
        """
        if not isinstance(getattr(env, "unwrapped", None), InfantEnv):
            given = described(env)
            raise MimocError(
                f"GrowthWrapper: expected the environment of one infant, got {given}; make it with mimoc.make, or call"
                " grow_by of a world or of many infants on the CPU"
            )
        super().__init__(env)
        if not callable(schedule):
            schedule = growth_schedule(schedule, ages_months, steps, seed=seed)
        infant: Any = env.unwrapped
        self._infant, self._schedule = infant, schedule
        self.steps_done = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode at the age that is due, unless the option `age_months` gives another.

        Raises:
            MimocError: If there is no such infant.
        """
        due = self._schedule(self.steps_done)
        options = {**(options or {})} if due == self._infant.age_months else {AGE: due, **(options or {})}
        return self.env.reset(seed=seed, options=options or None)

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Grow, if that is due, and take a control step.

        Raises:
            MimocError: If there is no such infant.
        """
        due = self._schedule(self.steps_done)
        if due != self._infant.age_months:
            self._infant.grow(to=due)
        stepped = self.env.step(action)
        self.steps_done += 1
        return stepped

    def seek(self, steps_done: int) -> None:
        """Go on as after a number of control steps, as a training does that is resumed; a reset must follow."""
        self.steps_done = steps_done
