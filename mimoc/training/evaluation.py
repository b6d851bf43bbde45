"""Evaluation of a policy, episode by episode."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.errors import TrainingError, UnknownNameError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.rollout import Policy, PolicyMaker, policy_of
from mimoc.senses.sense import FloatArray
from mimoc.units import ms_to_s


@dataclass(frozen=True, slots=True)
class Episode:
    """The outcome of one episode."""

    seed: int
    """Seed of its reset."""
    steps: int
    """Number of control steps."""
    duration_s: float
    """Duration in simulated time; the time to success if the episode was successful."""
    total_reward: float
    """The return: the sum of all rewards."""
    success: bool
    """Whether the goal was reached."""
    path_m: FloatArray | None
    """Positions of the tracked body at the start and after each control step, shape (steps + 1, 3), world frame."""


def evaluate(
    env: Any, policy: str | PolicyMaker, episodes: int, seed: int = 0, follow: str | None = None
) -> list[Episode]:
    """Run a policy for a number of episodes and return their outcomes.

    Episode i is reset with `seed + i`, so that all policies start from the same initial states.

    Args:
        env: An environment from `mimoc.make`; it is not closed.
        policy: Name of a policy, such as `random`, or a trained policy from `load_policy`.
        episodes: Number of episodes.
        seed: Seed of the first episode.
        follow: Name of a body, such as `right_fingers`, whose path is recorded.

    Raises:
        UnknownNameError: If there is no such policy or body.
        PolicyError: If the policy does not fit this infant.
        TrainingError: If the episodes of this infant do not end.
    """
    infant: InfantEnv = env.unwrapped
    if infant.max_steps is None:
        raise TrainingError(f"the episodes of '{infant.manifest.name}' do not end; set task.steps in its spec")
    bodies = [infant.model.body(index).name for index in range(infant.model.nbody)]
    if follow is not None and follow not in bodies:
        raise UnknownNameError("body of this infant", follow, bodies)
    acting = policy_of(infant, policy)
    return [_run_episode(infant, acting, seed + number, follow) for number in range(episodes)]


def _run_episode(env: InfantEnv, policy: Policy, seed: int, follow: str | None) -> Episode:
    generator = np.random.default_rng(seed)
    observation, _ = env.reset(seed=seed)
    path_m, total, steps, ended, success = [_position(env, follow)], 0.0, 0, False, False
    while not ended:
        observation, reward, terminated, truncated, info = env.step(policy(generator, observation))
        path_m.append(_position(env, follow))
        total, steps = total + reward, steps + 1
        ended, success = terminated or truncated, info["is_success"]
    duration_s = ms_to_s(steps * env.manifest.step_ms)
    return Episode(seed, steps, duration_s, total, success, np.array(path_m) if follow else None)


def _position(env: InfantEnv, body: str | None) -> FloatArray | None:
    return env.data.body(body).xpos.copy() if body else None
