"""Infants on a device as rsl_rl wants them, for its runners and for loops of one's own."""

from typing import Any

import torch
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode
from rsl_rl.env import VecEnv
from tensordict import TensorDict

from mimoc.base.errors import TrainingError
from mimoc.runtime.device.vector_env import DeviceEnv


class RslEnv(VecEnv):
    """Infants on a device, whose episodes begin anew in the same step in which they end.

    Observations are a `TensorDict` of one group for each sense, shape (k, n): name them in rsl_rl's `obs_groups`.
    Nothing leaves the device. Actions of any size may be given; the infants clip them.
    """

    def __init__(self, infants: DeviceEnv, limit: int | None = None):
        """Take infants that were made with `arrays="torch"` and `autoreset_mode="SameStep"`.

        Args:
            infants: The infants.
            limit: Control steps after which rsl_rl counts an episode as long as it gets; None is that of the task.

        Raises:
            TrainingError: If they were made otherwise, or see pictures.
        """
        if infants.arrays != "torch" or infants.autoreset_mode != AutoresetMode.SAME_STEP:
            raise TrainingError('rsl_rl needs arrays="torch" and autoreset_mode="SameStep"; make the infants so')
        spaces: Any = infants.single_observation_space
        self.spaces: dict[str, Box] = dict(spaces.spaces)
        """The space of each observation of one infant, in the order in which they are read."""
        for name, space in self.spaces.items():
            if space.dtype == "uint8":
                raise TrainingError(f"'{name}' is pictures, from which nothing learns on a device yet; leave it out")
        self.infants, self.num_envs = infants, infants.num_envs
        self.num_actions = int(infants.single_action_space.shape[0])  # pyright: ignore[reportOptionalSubscript]
        self.max_episode_length = limit or infants.infants[0].max_steps or 10**9
        self.device, self.cfg = infants.worlds.ended.steps.device, {}
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long, device=self.device)
        self._observed: TensorDict | None = None

    def get_observations(self) -> TensorDict:
        """Return what the infants observe now; the first time, all begin an episode."""
        if self._observed is None:
            self.reset()
        assert self._observed is not None
        return self._observed

    def reset(self, seed: int | None = None) -> TensorDict:
        """Let all infants begin an episode, and return what they observe."""
        observed, _ = self.infants.reset(seed=seed)
        self.episode_length_buf.zero_()
        self._observed = self._groups(observed)
        return self._observed

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """Apply an action of each infant, shape (k, n).

        Returns:
            Observations, of those that ended already of their next episode; rewards, shape (k,); whether an episode
            ended, shape (k,); and extras: `time_outs`, shape (k,), whether it was only cut off, `success`, shape (k,),
            and `log`, means of the terms of the reward.
        """
        observed, reward, terminated, truncated, info = self.infants.step(actions)
        done = terminated | truncated
        self.episode_length_buf += 1
        self.episode_length_buf *= ~done
        terms = {f"reward/{name}": term.mean() for name, term in info["reward_terms"].items()}
        extras = {"time_outs": truncated & ~terminated, "success": info["is_success"].clone(), "log": terms}
        self._observed = self._groups(observed)
        return self._observed, reward.float().clone(), done.long(), extras

    def close(self) -> None:
        """Close the infants."""
        self.infants.close()

    def _groups(self, observed: dict[str, torch.Tensor]) -> TensorDict:
        """Return a copy of observations: the infants' own memory is written to in the next step."""
        flat = {name: observed[name].reshape(self.num_envs, -1).float().clone() for name in self.spaces}
        return TensorDict(flat, batch_size=[self.num_envs])
