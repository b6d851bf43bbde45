"""How well an infant does under a policy, episode by episode."""

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
    """What happened in one episode."""

    seed: int
    """Of its reset."""
    steps: int
    """Control steps."""
    duration_s: float
    """Simulated time; of an episode that reached the goal, the time that took."""
    total_reward: float
    success: bool
    """Whether the goal was reached."""
    path_m: FloatArray | None
    """Where what is followed was at the start and after each control step, shape (steps + 1, 3), in the world."""


def evaluate(
    env: Any, policy: str | PolicyMaker, episodes: int, seed: int = 0, follow: str | None = None
) -> list[Episode]:
    """Return what happens in some episodes; those of one seed begin alike under every policy.

    Args:
        env: An environment of mimoc's, as `mimoc.make` returns it; it is left open.
        policy: The name of one, such as `random`, or what `load_policy` returns.
        episodes: How many.
        seed: Of the first episode; each has that of the one before plus one.
        follow: A body of the model, such as `right_fingers`, whose path is kept.

    Raises:
        UnknownNameError: If there is no such policy or body.
        PolicyError: If it is the policy of another infant.
        TrainingError: If the infant's episodes have no end.
    """
    infant: InfantEnv = env.unwrapped
    if infant.manifest.task.steps is None:
        raise TrainingError(f"the episodes of '{infant.manifest.name}' have no end; give its task steps in the spec")
    bodies = [infant.model.body(index).name for index in range(infant.model.nbody)]
    if follow is not None and follow not in bodies:
        raise UnknownNameError("body of this infant", follow, bodies)
    acting = policy_of(infant, policy)
    return [_episode(infant, acting, seed + number, follow) for number in range(episodes)]


def _episode(env: InfantEnv, policy: Policy, seed: int, follow: str | None) -> Episode:
    generator = np.random.default_rng(seed)
    observation, _ = env.reset(seed=seed)
    path_m, total, steps, ended, success = [_place(env, follow)], 0.0, 0, False, False
    while not ended:
        observation, reward, terminated, truncated, info = env.step(policy(generator, observation))
        path_m.append(_place(env, follow))
        total, steps = total + reward, steps + 1
        ended, success = terminated or truncated, info["is_success"]
    duration_s = ms_to_s(steps * env.manifest.step_ms)
    return Episode(seed, steps, duration_s, total, success, np.array(path_m) if follow else None)


def _place(env: InfantEnv, body: str | None) -> FloatArray | None:
    return env.data.body(body).xpos.copy() if body else None
