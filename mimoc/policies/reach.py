"""A policy that reaches for random targets by inverse dynamics, and its errors over time."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.units import ms_to_s
from mimoc.policies.control.reaching import ReachController, ReachGains
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation

NEXT_TARGETS_S = 1.5  # How long hands have to get to their targets.
REACHED_M = 0.02  # A hand that was this near to its target at any time before the next one has reached it; a choice.


class ReachPolicy:
    """Hands reach for random targets, or for the ball of the task `reach`; eyes look at the target of one hand.

    Hands and eyes that take no commands are left out.
    """

    def __init__(self, env: Infant, gains: ReachGains | None = None, next_targets_s: float = NEXT_TARGETS_S):
        """Bind it to an infant; ControlError if it has servos, or no hand that takes commands.

        Without *gains*, these are gentle for an infant that sits freely, and strong for all others; other targets are
        drawn after a time.
        """
        self._env, self._gains = env, gains
        self._period = max(1, round(next_targets_s / ms_to_s(env.manifest.step_ms)))
        self._steps = 0
        self._errors_m: list[list[float]] = []  # Of each turn, by hand: just before the next targets, and the least.
        self._least_m: list[list[float]] = []
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
                self._errors_m.append(self.errors()[0])
            self._least_m.append([np.inf] * len(self._control.hands))
            places_m = self._control.draw(generator)
            if places_m is not None:  # Where there are none to be had, hands keep those that they have.
                self._control.aim(places_m, turn)
        if self._control.sits_freely and self._fell_after_s is None and self._control.lies:
            self._fell_after_s = ms_to_s(self._steps * self._env.manifest.step_ms)
        if self._ball is None:
            self._least_m[-1] = [*map(min, self._least_m[-1], self.errors()[0])]
        self._steps += 1
        return self._control()

    def errors(self) -> tuple[list[float], list[float]]:
        """Return how far each hand [m] and each eye [rad] is from its target now."""
        return self._control.errors()

    def metrics(self) -> dict[str, float]:
        """Return what a run tells of reaching, as far as there is something to tell.

        `hand_error_m` is the median distance of hands from their targets just before others are drawn, `hand_targets`
        the number of targets that each hand has had for the whole time; of each hand, `left_hand_error_m` is the same,
        and `left_hand_reached_share` the share of its targets to which it came within `REACHED_M`. `fell_after_s` is
        the simulated time after which an infant that sat freely fell over.
        """
        metrics: dict[str, float] = {}
        if self._errors_m:
            errors_m, least_m = np.array(self._errors_m), np.array(self._least_m[: len(self._errors_m)])
            metrics = {"hand_error_m": float(np.median(errors_m)), "hand_targets": len(errors_m)}
            for number, hand in enumerate(self._control.hands):
                hand = self._env.manifest.of_infant(hand)
                metrics[f"{hand}_error_m"] = float(np.median(errors_m[:, number]))
                metrics[f"{hand}_reached_share"] = float(np.mean(least_m[:, number] <= REACHED_M))
        if self._fell_after_s is not None:
            metrics["fell_after_s"] = self._fell_after_s
        return metrics

    def _bind(self) -> None:
        env = self._env
        self._model = env.model
        self._control = ReachController(env.model, env.data, env.manifest, self._gains)
        task: Any = env.manifest.task
        self._ball = env.model.body(task.ball.body).id if task.kind == "reach" else None


def bind(env: Infant) -> ReachPolicy:
    """Return the policy for an environment; see `ReachPolicy`."""
    return ReachPolicy(env)


@dataclass(frozen=True, slots=True)
class ReachErrors:
    """Errors of hands and eyes in n trials of t control steps."""

    time_s: FloatArray  # Since the targets were drawn, shape (t + 1,), from 0 on.
    hands_m: FloatArray  # Distance of each hand from its target, shape (n, t + 1, number of hands).
    eyes_rad: FloatArray  # Angle between each eye's line of sight and its target, shape (n, t + 1, number of eyes).


def reach_errors(
    env: InfantEnv,
    gains: ReachGains,
    generator: np.random.Generator,
    trials: int = 10,
    seconds: float = 2.0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> ReachErrors:
    """Let an infant reach from its starting pose for random targets, and return the errors over time.

    It is reset for each trial, which has a target for each hand; the eyes look at that of the first. Raises a
    ControlError if it has servos, or no hand that takes commands.
    """
    step_s = ms_to_s(env.manifest.step_ms)
    steps = round(seconds / step_s)
    trials_errors = []
    for trial in range(trials):
        observation, _ = env.reset(seed=trial)
        policy = ReachPolicy(env, gains, seconds + step_s)
        action = policy(generator, observation)
        errors = [policy.errors()]
        for _ in range(steps):
            observation, *_ = env.step(action)
            errors.append(policy.errors())
            action = policy(generator, observation)
        trials_errors.append(([hands for hands, _ in errors], [eyes for _, eyes in errors]))
        progress(trial + 1, trials)
    hands_m, eyes_rad = (np.array(errors) for errors in zip(*trials_errors, strict=True))
    return ReachErrors(step_s * np.arange(steps + 1, dtype=np.float64), hands_m, eyes_rad)
