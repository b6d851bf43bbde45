"""Infants on one device that several learners share."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict

from mimoc.runtime.batch.gymnasium_forms import RESET_MASK
from mimoc.training.rsl_rl_env import InfantRslEnv, without_gradients

Outcome = tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]
"""What `InfantRslEnv.step` returns."""


class Share:
    """Some of the infants on a device: those that one learner learns from."""

    def __init__(self, env: InfantRslEnv, first: int = 0, every: int = 1):
        """Take the infant *first* of each *every* that follow one another."""
        self.env, self.which = env, slice(first, None, every)
        self.num_envs, self.num_actions = len(range(env.num_envs)[self.which]), env.num_actions
        self.infants, self.device = env.infants, env.device
        self.max_episode_length = env.max_episode_length

    def get_observations(self) -> TensorDict:
        """Return what these infants observe."""
        return self.env.get_observations()[self.which]

    @without_gradients
    def reset(self, seed: int) -> TensorDict:
        """Begin an episode of each of these infants, with *seed* and the seeds that follow; others go on."""
        mask, seeds = np.zeros(self.env.num_envs, dtype=bool), np.full(self.env.num_envs, None)
        mask[self.which], seeds[self.which] = True, range(seed, seed + self.num_envs)
        self.infants.reset(seed=seeds.tolist(), options={RESET_MASK: mask})
        return self.get_observations()

    def spread(self) -> None:
        """Let the episodes that have just begun end at random times, so that infants are not all equally far in theirs.

        Otherwise each update would learn from one part of an episode only.
        """
        ended = self.infants.worlds.ended
        shares = torch.rand(self.num_envs, device=self.device)
        ended.steps[self.which] = (shares * ended.limits[self.which]).to(ended.steps.dtype)

    async def step(self, actions: torch.Tensor) -> Outcome:
        """Make a control step with actions of these infants, when all learners have chosen theirs."""
        observation, rewards, dones, extras = await WantedStep(self, actions)
        of_share = {name: values[self.which] for name, values in extras.items() if name != "log"}
        return observation[self.which], rewards[self.which], dones[self.which], of_share


@dataclass(frozen=True)
class WantedStep:
    """A control step that a learner waits for."""

    share: Share
    actions: torch.Tensor

    def __await__(self) -> Generator["WantedStep", Outcome, Outcome]:
        """Wait for it, and return what comes of the step of all."""
        return (yield self)

    def step_with(self, others: Sequence["WantedStep"]) -> Outcome:
        """Make a step of all infants; those whose learner has ended do nothing."""
        env = self.share.env
        actions = torch.zeros((env.num_envs, env.num_actions), device=env.device)
        for step in (self, *others):
            actions[step.share.which] = step.actions
        return env.step(actions)
