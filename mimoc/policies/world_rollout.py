"""Run the infants of a world under policies, and summarise what each did."""

from time import perf_counter

import numpy as np

from mimoc.policies.named import Loader, Policies, policies_of
from mimoc.policies.policy import begin, start_again
from mimoc.policies.rollout import Summary, Tally
from mimoc.policies.starting import check_apart
from mimoc.runtime.world_env import WorldEnv


class WorldRun:
    """A run of a world under a policy of each infant, each with its own numbers drawn at random."""

    def __init__(self, world: WorldEnv, policy: Policies, seed: int, load: Loader | None = None):
        """Reset the world.

        Args:
            world: The world.
            policy: The policy of all infants, or policies by infant; see `policies_of`.
            seed: Of the reset and the policies; that of infant i draws from `seed + i`.
            load: Loads trained policies.

        Raises:
            UnknownNameError: If there is no such policy or infant.
            PolicyError: If its name lacks something, or it does not fit an infant.
        """
        self.world = world
        self.observations, _ = world.reset(seed=seed)
        self._policies = policies_of(world.infants, policy, load)
        self._begin()
        self._tallies = {name: Tally(infant) for name, infant in world.infants.items()}
        self._generators = {name: np.random.default_rng(seed + number) for number, name in enumerate(world.infants)}
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
            self._begin()

    def _begin(self) -> None:
        """Let policies put their infants where episodes begin."""
        begun = [begin(policy) for policy in self._policies.values()]
        if any(observation is not None for observation in begun):
            check_apart(self.world.infants)
            self.observations = {name: infant.observe() for name, infant in self.world.infants.items()}

    def summaries(self) -> dict[str, Summary]:
        """Return the summary of each infant's steps so far, of which there must be at least one."""
        return {name: tally.summary(self._wall_s, self._policies[name]) for name, tally in self._tallies.items()}
