"""Run the infants of a world under a policy, and summarise what each did."""

from time import perf_counter
from typing import Any

import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.base.units import ms_to_s
from mimoc.policies.named import Loader, policy_of
from mimoc.policies.policy import Policy, metrics_of, start_again
from mimoc.policies.spec import parse_policy
from mimoc.quantities.measuring import Outcome, StepMeasures, measure
from mimoc.runtime.rollout import Summary
from mimoc.runtime.shared_world import SharedWorld
from mimoc.runtime.world_infant import WorldInfant

SHARING = ("random", "zero", "general_movements", "reflexes")
"""Policies that take no other things of a model than those of their infant."""


class WorldRun:
    """A run of a world under a policy, the same for all infants, each with its own numbers drawn at random."""

    def __init__(self, world: SharedWorld, policy: str, seed: int, load: Loader | None = None):
        """Reset the world.

        Args:
            world: The world.
            policy: Name of a policy, or a sum of names; see `policy_of`.
            seed: Of the reset and the policies; that of infant i draws from `seed + i`.
            load: Loads trained policies.

        Raises:
            UnknownNameError: If there is no such policy.
            PolicyError: If its name lacks something, it does not fit an infant, or it is for one that is alone.
        """
        check_policy(policy)
        self.world = world
        self.observations, _ = world.reset(seed=seed)
        self._runs = {
            name: _InfantRun(infant, policy, seed + number, load)
            for number, (name, infant) in enumerate(world.infants.items())
        }
        self._wall_s, self._steps = 0.0, 0

    def step(self) -> None:
        """Take one control step; once the episodes of all infants have ended, the next ones start."""
        actions = {name: self._runs[name].act(self.observations[name]) for name in self.world.agents}
        start = perf_counter()
        self.observations, rewards, terminated, truncated, infos = self.world.step(actions)
        self._wall_s, self._steps = self._wall_s + perf_counter() - start, self._steps + 1
        for name in actions:
            self._runs[name].add(rewards[name], infos[name], ended=terminated[name] or truncated[name])
        if not self.world.agents:
            self.observations, _ = self.world.reset()
            for run in self._runs.values():
                start_again(run.policy)

    def summaries(self) -> dict[str, Summary]:
        """Return the summary of each infant's steps so far, of which there must be at least one."""
        return {name: run.summary(self._wall_s) for name, run in self._runs.items()}


class _InfantRun:
    """What one infant does and earns."""

    def __init__(self, infant: WorldInfant, policy: str, seed: int, load: Loader | None):
        of_one: Any = infant  # Policies read of an environment what there is of this infant as well.
        self.policy: Policy = policy_of(of_one, policy, load)
        self._infant, self._generator = infant, np.random.default_rng(seed)
        self._measures, self._outcomes = StepMeasures(infant, "run"), list[Outcome]()
        self._reward, self._steps, self._earned, self._taken = 0.0, 0, 0.0, 0

    def act(self, observation: Any) -> np.ndarray:
        return self.policy(self._generator, observation)

    def add(self, reward: float, info: dict[str, Any], *, ended: bool) -> None:
        self._reward, self._steps = self._reward + reward, self._steps + 1
        self._earned, self._taken = self._earned + reward, self._taken + 1
        self._measures.add(info)
        if ended:
            time_s = ms_to_s(self._taken * self._infant.manifest.step_ms)
            success = info["is_success"]
            self._outcomes.append(Outcome(self._earned, self._taken, success, time_s if success else None))
            self._earned, self._taken = 0.0, 0

    def summary(self, wall_s: float) -> Summary:
        manifest = self._infant.manifest
        return Summary(
            steps=self._steps,
            episodes=len(self._outcomes) + (self._taken > 0),
            simulated_s=ms_to_s(self._steps * manifest.step_ms),
            wall_s=wall_s,
            total_reward=self._reward,
            task=manifest.task.kind,
            finished=len(self._outcomes),
            successes=sum(outcome.success for outcome in self._outcomes),
            measures={**measure("episode", "run", self._outcomes), **self._measures.measures()},
            metrics=metrics_of(self.policy),
        )


def check_policy(policy: str) -> None:
    """Check that a policy is one for infants that share a world.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If it is not.
    """
    for part in parse_policy(policy):
        if part.kind is not None and part.kind.name not in SHARING:
            raise PolicyError(
                f"'{part.label}' reads a model with one infant only; infants that share a world can have "
                f"{', '.join(SHARING)}, sums of these, and trained policies"
            )
