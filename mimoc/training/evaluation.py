"""Evaluation of a policy, episode by episode."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.errors import TrainingError, UnknownNameError
from mimoc.base.units import ms_to_s
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Policy, PolicyMaker, episode_limit_of, start_again
from mimoc.runtime.env import InfantEnv, infant_of
from mimoc.runtime.sense import FloatArray
from mimoc.training.loading import load_policy


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
    env: Any,
    policy: str | PolicyMaker,
    episodes: int,
    seed: int = 0,
    follow: str | None = None,
    steps_per_episode: int | None = None,
) -> list[Episode]:
    """Run a policy for a number of episodes and return their outcomes.

    Episode i is reset with `seed + i`, so that all policies start from the same initial states.

    Args:
        env: An environment from `mimoc.make`; it is not closed.
        policy: Name of a policy, such as `random`, the path of a trained one, a sum of these
            (`policy.zip+reflexes`), or a trained policy from `load_policy`.
        episodes: Number of episodes.
        seed: Seed of the first episode.
        follow: Name of a body, such as `right_fingers`, whose path is recorded.
        steps_per_episode: Control steps after which an episode ends, unless the task ends it earlier; by default as in
            the training of the policy, or as `max_episode_steps` of the environment says.

    Raises:
        UnknownNameError: If there is no such policy or body.
        PolicyError: If the policy does not fit this infant.
        TrainingError: If nothing ends the episodes of this infant.
        TypeError: If it is no environment of one infant.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("reach.yaml", max_episode_steps=5)
        >>> episodes = mimoc.evaluate(env, "random", episodes=2)
        >>> [episode.steps for episode in episodes]
        [5, 5]
    """
    infant = infant_of("evaluate", env)
    bodies = [infant.model.body(index).name for index in range(infant.model.nbody)]
    if follow is not None and follow not in bodies:
        raise UnknownNameError("body of this infant", follow, bodies)
    acting = policy_of(infant, policy, load_policy)
    around = getattr(env.spec, "max_episode_steps", None) or math.inf
    limit = steps_per_episode or min(around, episode_limit_of(acting))
    if infant.max_steps is None and limit == math.inf:
        name = infant.manifest.name
        raise TrainingError(
            f"the episodes of '{name}' do not end; give steps_per_episode, or set task.steps in its spec"
        )
    return [_run_episode(infant, acting, seed + number, follow, limit) for number in range(episodes)]


def _run_episode(env: InfantEnv, policy: Policy, seed: int, follow: str | None, limit: float) -> Episode:
    generator = np.random.default_rng(seed)
    observation, _ = env.reset(seed=seed)
    start_again(policy)
    path_m, total, steps, ended, success = [_position(env, follow)], 0.0, 0, False, False
    while not ended:
        observation, reward, terminated, truncated, info = env.step(policy(generator, observation))
        path_m.append(_position(env, follow))
        total, steps = total + reward, steps + 1
        ended, success = terminated or truncated or steps >= limit, info["is_success"]
    duration_s = ms_to_s(steps * env.manifest.step_ms)
    return Episode(seed, steps, duration_s, total, success, np.array(path_m) if follow else None)


def _position(env: InfantEnv, body: str | None) -> FloatArray | None:
    return env.data.body(body).xpos.copy() if body else None
