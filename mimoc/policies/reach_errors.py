"""How hands and eyes come to random targets over time, in trials that each start anew."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimoc.control.reaching import ReachGains
from mimoc.policies.reach import ReachPolicy
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import FloatArray
from mimoc.units import ms_to_s


@dataclass(frozen=True, slots=True)
class ReachErrors:
    """Errors of hands and eyes in n trials of t control steps."""

    time_s: FloatArray
    """Since the targets were drawn, shape (t + 1,), from 0 on."""
    hands_m: FloatArray
    """Distance of each hand from its target, shape (n, t + 1, number of hands)."""
    eyes_rad: FloatArray
    """Angle between each eye's line of sight and its target, shape (n, t + 1, number of eyes)."""


def reach_errors(
    env: InfantEnv,
    gains: ReachGains,
    generator: np.random.Generator,
    trials: int = 10,
    seconds: float = 2.0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> ReachErrors:
    """Let an infant reach from its starting pose for random targets, and return the errors over time.

    Args:
        env: The infant, with motors or muscles; it is reset for each trial.
        gains: For hands and eyes, such as one of `mimoc.control.GAIN_SETS`.
        generator: Source of the targets.
        trials: Number of trials, each with a target for each hand; the eyes look at that of the first.
        seconds: Simulated time of a trial.
        progress: Called with the number of trials done, and of all.

    Raises:
        ControlError: If the infant has servos, or no hand that takes commands.
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
