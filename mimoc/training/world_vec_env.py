"""The infants of worlds as rows of an environment of Stable-Baselines3, which all learn one policy."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvObs, VecEnvStepReturn

from mimoc.runtime.batch.gymnasium_forms import check_mixture
from mimoc.runtime.shared_world import SharedWorld
from mimoc.runtime.world_infant import WorldInfant
from mimoc.senses.sense import Observation


class WorldVecEnv(VecEnv):
    """Infants of one world or several, a row each, in the order of worlds and of infants in them.

    When the episode of any infant ends, those of the others in its world are truncated, and the world is reset in the
    same step. The `info` of a last step has what was observed then as `terminal_observation`.
    """

    def __init__(self, worlds: Sequence[SharedWorld], max_episode_steps: int | None = None):
        """Take worlds, which this closes, and perhaps the control steps after which any episode is truncated.

        Raises:
            BatchMismatchError: If infants do not observe and command the same.
        """
        self.worlds, self._limit = tuple(worlds), max_episode_steps or math.inf
        self.infants: list[WorldInfant] = [infant for world in worlds for infant in world.infants.values()]
        check_mixture(self.infants)
        first, self.render_mode = self.infants[0], self.worlds[0].render_mode
        super().__init__(len(self.infants), first.observation_space, first.action_space)

    def reset(self) -> VecEnvObs:
        """Reset all worlds with the seeds that were set, and return what the infants observe."""
        rows: list[Observation] = []
        for world in self.worlds:
            observations, _ = world.reset(seed=self._seeds[len(rows)])
            rows += observations.values()
        self._reset_seeds()
        self._reset_options()
        return _stacked(rows)

    def step_async(self, actions: npt.NDArray[Any]) -> None:
        """Take an action of each infant, shape (n, actuators)."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Make the step; rewards are in single precision."""
        rows, rewards, done, infos = list[Observation](), list[float](), list[bool](), list[dict[str, Any]]()
        for world in self.worlds:
            names = world.possible_agents
            actions = dict(zip(names, self._actions[len(rows) : len(rows) + len(names)], strict=True))
            observations, earned, terminated, truncated, said = world.step(actions)
            has_ended = any(terminated.values()) or any(truncated.values())
            has_ended = has_ended or world.infants[names[0]].steps >= self._limit
            for name in names:
                infos.append({**said[name], "TimeLimit.truncated": has_ended and not terminated[name]})
                if has_ended:
                    infos[-1]["terminal_observation"] = observations[name]
            if has_ended:
                observations, _ = world.reset()
            rows += (observations[name] for name in names)
            rewards += (earned[name] for name in names)
            done += [has_ended] * len(names)
        return _stacked(rows), np.array(rewards, np.float32), np.array(done), infos

    def close(self) -> None:
        """Close all worlds; closing twice is fine."""
        for world in self.worlds:
            world.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of each infant."""
        if attr_name == "render_mode":
            return [self.render_mode for _ in self._get_indices(indices)]
        return [getattr(self.infants[index], attr_name) for index in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set an attribute of each infant."""
        for index in self._get_indices(indices):
            setattr(self.infants[index], attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **kwargs: Any
    ) -> list[Any]:
        """Call a method of each infant."""
        infants = (self.infants[index] for index in self._get_indices(indices))
        return [getattr(infant, method_name)(*method_args, **kwargs) for infant in infants]

    def env_is_wrapped(self, wrapper_class: Any, indices: VecEnvIndices = None) -> list[bool]:
        """Return of each infant that it is not wrapped."""
        return [False for _ in self._get_indices(indices)]

    def get_images(self) -> list[npt.NDArray[np.uint8] | None]:
        """Return a picture of each world."""
        return [world.render() for world in self.worlds]


def _stacked(rows: Sequence[Observation]) -> VecEnvObs:
    """Return observations with a leading axis of infants."""
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]}
