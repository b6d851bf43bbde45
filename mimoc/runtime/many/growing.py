"""Many infants that grow with the number of their steps."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode

from mimoc.render.renderer import sharing
from mimoc.runtime.closing import closable
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import AGE
from mimoc.runtime.many.vector_env import ManyInfants, SteppedEach
from mimoc.senses.sense import Observation


@closable("seek")
class GrowingInfants(ManyInfants):
    """Infants that grow side by side: each lives as it would alone in the wrapper `Growing`."""

    def __init__(
        self,
        openers: Sequence[Callable[[], InfantEnv]],
        schedule: Callable[[int], float],
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
    ):
        """Open infants and join them.

        Args:
            openers: What opens each.
            schedule: From the number of control steps that an infant has taken to its age in months.
            threads: As for `ManyInfants`, as are the next two.
            autoreset_mode: See there.
            max_episode_steps: See there.

        Raises:
            MixtureError: If they do not sense and command the same.
        """
        super().__init__(openers, threads, autoreset_mode, max_episode_steps)
        self._age_due, self.steps_done = schedule, np.zeros(self.num_envs, int)

    def step_each(self, actions: npt.NDArray[Any]) -> SteppedEach:
        """Let those grow that are due, and make a step.

        Raises:
            MimocError: If there is no such infant.
        """
        self._checked(actions)
        for infant in np.flatnonzero(~self._ended).tolist():
            self._grow_if_due(infant)
            self.steps_done[infant] += 1
        return super().step_each(actions)

    def seek(self, steps_done: int) -> None:
        """Go on as after a number of control steps of each, as a training does that is resumed; a reset must follow."""
        self.steps_done[:] = steps_done

    def _grow_if_due(self, infant: int) -> None:
        due = self._age_due(int(self.steps_done[infant]))
        if due != self.infants[infant].age_months:
            with sharing(self._renderers):
                self.infants[infant].grow(to=due)

    def _reset_one(
        self, infant: int, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode of one infant at the age that is due, unless the option `age_months` gives another."""
        due = self._age_due(int(self.steps_done[infant]))
        if due != self.infants[infant].age_months:
            options = {AGE: due, **(options or {})}
        return super()._reset_one(infant, seed, options)
