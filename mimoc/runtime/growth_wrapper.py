"""An environment whose infant grows with the number of its steps."""

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np

from mimoc.base.classes import described
from mimoc.base.errors import MimocError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import OLDEST_MONTHS
from mimoc.runtime.growth_schedule import growth_schedule
from mimoc.runtime.simulation import Simulation


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
            raise MimocError(f"only the environment of an infant can grow; make it with mimoc.make, not {given}")
        super().__init__(env)
        if not callable(schedule):
            schedule = growth_schedule(schedule, ages_months, steps, seed=seed)
        self._simulation.grow_by({"": schedule})

    @property
    def _simulation(self) -> Simulation:
        infant: Any = self.env.unwrapped
        return infant.simulation

    @property
    def steps_done(self) -> int:
        """Control steps taken so far."""
        return self._simulation.steps_done

    def seek(self, steps_done: int) -> None:
        """Go on as after a number of control steps, as a training does that is resumed; a reset must follow."""
        self._simulation.steps_done = steps_done
