"""A policy that reaches for random targets by inverse dynamics."""

from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.control.reaching import ReachController, ReachGains
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation
from mimoc.units import ms_to_s

NEXT_TARGETS_S = 1.5
"""How long hands have to get to their targets."""


class ReachPolicy:
    """Hands reach for random targets, or for the ball of the task `reach`; eyes look at the target of one hand.

    Hands and eyes that take no commands are left out.
    """

    def __init__(self, env: InfantEnv, gains: ReachGains | None = None, next_targets_s: float = NEXT_TARGETS_S):
        """Bind it to an infant.

        Args:
            env: The infant, with motors or muscles.
            gains: For hands and eyes; None is gentle for an infant that sits freely, and strong for all others.
            next_targets_s: Time after which other targets are drawn.

        Raises:
            ControlError: If the infant has servos, or no hand that takes commands.
        """
        self._env, self._gains = env, gains
        self._period = max(1, round(next_targets_s / ms_to_s(env.manifest.step_ms)))
        self._steps = 0
        self._errors_m: list[float] = []
        self._fell_after_s: float | None = None
        self._bind()

    def __call__(self, generator: np.random.Generator, observation: Observation) -> npt.NDArray[np.float32]:
        """Return the action; it does not depend on the observation."""
        if self._env.model is not self._model:
            self._bind()  # The scene has changed.
        turn, step = divmod(self._steps, self._period)
        if self._ball is not None:
            self._control.aim([self._env.data.xpos[self._ball]] * len(self._control.hands))
        elif step == 0:
            if turn:
                self._errors_m += self.errors()[0]
            self._draw_targets(generator, turn)
        if self._control.sits_freely and self._fell_after_s is None and self._control.lies:
            self._fell_after_s = ms_to_s(self._steps * self._env.manifest.step_ms)
        self._steps += 1
        return self._control()

    def errors(self) -> tuple[list[float], list[float]]:
        """Return how far each hand [m] and each eye [rad] is from its target now."""
        return self._control.errors()

    def metrics(self) -> dict[str, float]:
        """Return what a run tells of reaching, as far as there is something to tell.

        `hand_error_m` is the median distance of hands from their targets just before others are drawn; `fell_after_s`
        is the simulated time after which an infant that sat freely fell over.
        """
        metrics: dict[str, float] = {}
        if self._errors_m:
            metrics["hand_error_m"] = float(np.median(self._errors_m))
        if self._fell_after_s is not None:
            metrics["fell_after_s"] = self._fell_after_s
        return metrics

    def _bind(self) -> None:
        env = self._env
        self._model = env.model
        self._control = ReachController(env.model, env.data, env.manifest, self._gains)
        task: Any = env.manifest.task
        self._ball = env.model.body(task.ball.body).id if task.kind == "reach" else None

    def _draw_targets(self, generator: np.random.Generator, watched: int) -> None:
        """Draw a target for each hand; where there are none to be had, hands keep those that they have."""
        places_m = self._control.draw(generator)
        if places_m is not None:
            self._control.aim(places_m, watched)


def bind(env: InfantEnv) -> ReachPolicy:
    """Return the policy for an environment.

    Raises:
        ControlError: If the infant has servos, or no hand that takes commands.
    """
    return ReachPolicy(env)
