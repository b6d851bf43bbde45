"""Many infants on a device as rsl_rl learns from them."""

from collections.abc import Callable
from functools import wraps
from types import MappingProxyType
from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode

from mimoc.base.errors import MimocError, MissingExtraError
from mimoc.runtime.device.vector_env import DeviceEnv
from mimoc.runtime.gymnasium_forms import RESET_MASK

try:
    from rsl_rl.env import VecEnv
    from tensordict import TensorDict
except ImportError:
    raise MissingExtraError("rsl-rl-lib", "gpu") from None

GROUP = "policy"  # Name of the only group of observations.
NO_IMAGES = "is an image, which networks of plain layers do not learn from on a device; leave out vision, or device"
LIMIT = 2**31 - 1  # Length of episodes that nothing ends, as a number.


def without_gradients(method: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method that computes no gradients, and whose tensors can be written to after rsl_rl's inference mode."""

    @wraps(method)
    def inner(*arguments: Any, **named: Any) -> Any:
        with torch.inference_mode(False), torch.no_grad():
            return method(*arguments, **named)

    return inner


class InfantRslEnv(VecEnv):
    """rsl_rl's view of many infants: those whose episode ends are reset in the same step.

    All that an infant observes is side by side in the group `policy`, in the order of the sorted names of its
    observations, shape (num_envs, numbers), in single precision.
    """

    def __init__(self, infants: DeviceEnv, seed: int = 0):
        """Give infants to rsl_rl, and reset them with a seed; closing them stays with the caller."""
        if infants.autoreset_mode != AutoresetMode.SAME_STEP or infants.arrays != "torch":
            raise MimocError("rsl_rl needs infants made with arrays='torch' and autoreset_mode='SameStep'")
        check_plain(infants.single_observation_space)
        space: Any = infants.single_action_space
        self.infants = infants
        self.num_envs = infants.num_envs
        self.num_actions = space.shape[0]
        limits = infants.worlds.ended.limits
        self.max_episode_length = min(int(limits.max()), LIMIT)
        """Control steps after which the longest episode is truncated."""
        self.device = limits.device
        self.cfg = MappingProxyType[str, Any]({})
        self.reset(seed)

    @property
    def episode_length_buf(self) -> torch.Tensor:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Control steps of each episode so far, shape (num_envs,); rsl_rl sets it to begin with episodes under way."""
        return self.infants.worlds.ended.steps

    @episode_length_buf.setter
    def episode_length_buf(self, steps: torch.Tensor) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        self.infants.worlds.ended.steps.copy_(steps)

    @without_gradients
    def reset(self, seed: int | None = None) -> TensorDict:
        """Begin an episode of each infant, and return what they observe."""
        return self._grouped(self.infants.reset(seed=seed)[0])

    @without_gradients
    def get_observations(self) -> TensorDict:
        """Return what the infants observe."""
        return self._grouped(self.infants.worlds.observation)

    @without_gradients
    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """Make a control step with an action of each infant, shape (num_envs, num_actions)."""
        observation, reward, terminated, truncated, info = self.infants.step(actions)
        flags_by_name = {name: info[name] for name in ("is_success", "overflowed")}
        log = {f"/{name}": flags.float().mean() for name, flags in flags_by_name.items()}
        log |= {f"/reward_terms/{name}": term.float().mean() for name, term in info["reward_terms"].items()}
        extras = {"time_outs": truncated & ~terminated, **flags_by_name, "log": log}
        return self._grouped(observation), reward.float(), terminated | truncated, extras

    def close(self) -> None:
        """Close the infants."""
        self.infants.close()

    def _grouped(self, observation: dict[str, torch.Tensor]) -> TensorDict:
        """Return a copy of all observations side by side: the next step overwrites the originals."""
        parts = [observation[name].flatten(1) for name in sorted(observation)]
        return TensorDict({GROUP: torch.cat(parts, dim=1)}, batch_size=[self.num_envs], device=self.device)


def check_plain(space: Any) -> None:
    """Raise a MimocError if there is an image among observations: uint8 is not for a plain network."""
    for name, part in space.spaces.items():
        if part.dtype == np.uint8:
            raise MimocError(f"'{name}' {NO_IMAGES}")


Outcome = tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]  # What `InfantRslEnv.step` returns.


class EnvRows:
    """Some of the infants on a device: those that one learner learns from."""

    def __init__(self, env: InfantRslEnv, first: int = 0, every: int = 1):
        """Select each *every*-th infant, from *first* on."""
        self.env = env
        self.which = slice(first, None, every)
        self.num_envs = len(range(env.num_envs)[self.which])
        self.num_actions = env.num_actions
        self.device = env.device

    def get_observations(self) -> TensorDict:
        """Return what these infants observe."""
        return self.env.get_observations()[self.which]

    @without_gradients
    def reset(self, seed: int) -> TensorDict:
        """Begin an episode of each of these infants, with *seed* and the seeds that follow; others go on."""
        mask = np.zeros(self.env.num_envs, dtype=bool)
        seeds = np.full(self.env.num_envs, None)
        mask[self.which] = True
        seeds[self.which] = range(seed, seed + self.num_envs)
        self.env.infants.reset(seed=seeds.tolist(), options={RESET_MASK: mask})
        return self.get_observations()

    def randomize_episode_phase(self) -> None:
        """Let the episodes that have just begun end at random times, so that infants are not all equally far in theirs.

        Otherwise each update would learn from one part of an episode only.
        """
        ended = self.env.infants.worlds.ended
        shares = torch.rand(self.num_envs, device=self.device)
        ended.steps[self.which] = (shares * ended.limits[self.which]).to(ended.steps.dtype)

    def part_of(self, outcome: Outcome) -> Outcome:
        """Return what a control step of all infants on the device means for these."""
        observation, rewards, dones, extras = outcome
        of_rows = {name: values[self.which] for name, values in extras.items() if name != "log"}
        return observation[self.which], rewards[self.which], dones[self.which], of_rows
