"""Many infants as an environment of Stable-Baselines3."""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv, VecMonitor
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvObs, VecEnvStepReturn

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.many.vector_env import ManyInfants

RESET_IN_THE_SAME_STEP = AutoresetMode.SAME_STEP
"""What Stable-Baselines3 expects of its environments."""


class InfantVecEnv(VecEnv):
    """Stable-Baselines3's view of many infants: those whose episode ends are reset in the same step.

    The `info` of a last step has what was observed then as `terminal_observation`, and `TimeLimit.truncated`.
    """

    def __init__(self, infants: ManyInfants):
        """Give infants that are reset in the same step to Stable-Baselines3, which closes them."""
        assert infants.autoreset_mode == RESET_IN_THE_SAME_STEP
        self.infants = infants
        super().__init__(infants.num_envs, infants.single_observation_space, infants.single_action_space)
        self._actions: npt.NDArray[Any] = np.zeros(infants.action_space.shape or (), np.float32)

    def reset(self) -> VecEnvObs:
        """Reset all infants with the seeds and options that were set, and return what they observe."""
        seeds, options = list(self._seeds), list(self._options)
        observation, infos = self.infants.reset_each(seeds, options)
        self.reset_infos = [infos[infant] for infant in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        return observation

    def step_async(self, actions: npt.NDArray[Any]) -> None:
        """Take the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Make the step; rewards are in single precision."""
        observation, rewards, terminated, truncated, infos = self.infants.step_each(self._actions)
        done = terminated | truncated
        told = []
        for infant in range(self.num_envs):
            info = infos[infant]
            if done[infant]:
                final, info, self.reset_infos[infant] = _taken_apart(info)
                info["terminal_observation"] = final
            info["TimeLimit.truncated"] = bool(truncated[infant] and not terminated[infant])
            told.append(info)
        return observation, rewards.astype(np.float32), done, told

    def seek(self, steps_done: int) -> None:
        """Let growing infants go on as after a number of control steps of each; a reset must follow."""
        self.infants.seek(steps_done)

    def close(self) -> None:
        """Close all infants; closing twice is fine."""
        self.infants.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of some infants."""
        return [getattr(each, attr_name) for each in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set an attribute of some infants to one value."""
        for each in self._chosen(indices):
            setattr(each, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **method_kwargs: Any
    ) -> list:
        """Return what a method of some infants returns."""
        return [getattr(each, method_name)(*method_args, **method_kwargs) for each in self._chosen(indices)]

    def env_is_wrapped(self, wrapper_class: type[gymnasium.Wrapper], indices: VecEnvIndices = None) -> list[bool]:
        """Return that no infant is in a wrapper of its own."""
        return [False for _ in self._chosen(indices)]

    def get_images(self) -> Sequence[npt.NDArray[np.uint8] | None]:
        """Return a picture of each infant."""
        return self.env_method("render")

    def _chosen(self, indices: VecEnvIndices) -> list[InfantEnv]:
        return [self.infants.infants[index] for index in self._get_indices(indices)]


def monitored(infants: ManyInfants) -> VecMonitor:
    """Return infants that are reset in the same step as Stable-Baselines3 wants them, with returns of episodes."""
    return VecMonitor(InfantVecEnv(infants))


def _taken_apart(info: dict[str, Any]) -> tuple[Any, dict[str, Any], dict[str, Any]]:
    """Return what was observed last, the info of the last step and that of the reset after it."""
    final, last = info["final_obs"], dict(info["final_info"])
    return final, last, {name: value for name, value in info.items() if name not in ("final_obs", "final_info")}
