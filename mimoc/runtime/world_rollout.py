"""Run the infants of a world under a policy, and summarise what each did."""

from time import perf_counter
from typing import Any

import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.named import Loader, policy_of
from mimoc.policies.policy import PolicyMaker, start_again
from mimoc.policies.spec import parse_policy
from mimoc.runtime.rollout import Summary, Tally
from mimoc.runtime.world_env import WorldEnv

SHARING = ("random", "zero", "general_movements", "reflexes")
"""Policies that take no other things of a model than those of their infant."""


class WorldRun:
    """A run of a world under a policy, the same for all infants, each with its own numbers drawn at random."""

    def __init__(self, world: WorldEnv, policy: str | PolicyMaker, seed: int, load: Loader | None = None):
        """Reset the world.

        Args:
            world: The world.
            policy: Name of a policy, a sum of names, or a function from an infant to its policy; see `policy_of`.
            seed: Of the reset and the policies; that of infant i draws from `seed + i`.
            load: Loads trained policies.

        Raises:
            UnknownNameError: If there is no such policy.
            PolicyError: If its name lacks something, it does not fit an infant, or it is for one that is alone.
        """
        check_policy(policy)
        self.world = world
        self.observations, _ = world.reset(seed=seed)
        infants: dict[str, Any] = world.infants  # Policies read of an environment what there is of these as well.
        self._policies = {name: policy_of(infant, policy, load) for name, infant in infants.items()}
        self._tallies = {name: Tally(infant) for name, infant in world.infants.items()}
        self._generators = {name: np.random.default_rng(seed + number) for number, name in enumerate(infants)}
        self._wall_s = 0.0

    def step(self) -> None:
        """Take one control step; once the episodes of all infants have ended, the next ones start."""
        actions = {
            name: self._policies[name](self._generators[name], self.observations[name]) for name in self.world.agents
        }
        start = perf_counter()
        self.observations, rewards, terminated, truncated, infos = self.world.step(actions)
        self._wall_s += perf_counter() - start
        for name in actions:
            self._tallies[name].add(rewards[name], infos[name])
            if terminated[name] or truncated[name]:
                self._tallies[name].end_episode(infos[name]["is_success"])
        if not self.world.agents:
            self.observations, _ = self.world.reset()
            for policy in self._policies.values():
                start_again(policy)

    def summaries(self) -> dict[str, Summary]:
        """Return the summary of each infant's steps so far, of which there must be at least one."""
        return {name: tally.summary(self._wall_s, self._policies[name]) for name, tally in self._tallies.items()}


def check_policy(policy: str | PolicyMaker) -> None:
    """Check that a policy is one for infants that share a world.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If it is not.
    """
    for part in parse_policy(policy) if isinstance(policy, str) else ():
        if part.kind is not None and part.kind.name not in SHARING:
            raise PolicyError(
                f"'{part.label}' reads a model with one infant only; infants that share a world can have "
                f"{', '.join(SHARING)}, sums of these, and trained policies"
            )
