"""Recording of infants on a device: actions, observations, rewards, and movement as far as its arrays say it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorWrapper

from mimoc.recording.movement_columns import GROUPS, checked_groups
from mimoc.recording.movement_columns.reader import bind_group
from mimoc.recording.recorder import PART_ROWS, Closing, Recording
from mimoc.runtime.batch.gymnasium_forms import options_of, reset_indices, seeds_of
from mimoc.runtime.growing import AGE
from mimoc.runtime.observer import NO_OBSERVER, Observer
from mimoc.runtime.sense import Observation

NOTE = (
    "recorded on a device, without states, and without movement columns of gaze, contacts and actuators, which need"
    " MuJoCo's data; record the same infants on the CPU to replay them"
)
FIELDS = ("qpos", "qvel", "act", "ctrl", "site_xpos", "xipos", "cvel", "subtree_com", "qfrc_actuator")
"""Arrays of a simulation that are taken from the device, which movement columns are computed from."""


class DeviceInfant:
    """The infant in one world of a device, with all of a single infant that a recording reads.

    Its model and its data are those of the infant that stands for it, to whose data the arrays of its world are copied
    before they are read.
    """

    observer: Observer = NO_OBSERVER

    def __init__(self, env: Any, world: int):
        self._env, self._world = env, world
        self.infants, self.simulation, self.observation_space = {"": self}, self, env.single_observation_space
        spaces = env.single_observation_space.spaces
        self.seen: Observation = {name: np.zeros(space.shape, space.dtype) for name, space in spaces.items()}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._env.assignment.infant(self._world), name)

    def get_state(self) -> dict[str, Any]:
        """Return nothing: states of a device are not recorded."""
        return {}

    def observe(self) -> Observation:
        """Return what it observed last."""
        return self.seen


class DeviceRecorder(Closing, VectorWrapper):
    """A vector environment on a device whose infants' episodes are recorded, from their first reset on."""

    def __init__(
        self, env: Any, folder: str | Path, *, part_rows: int = PART_ROWS, movement: Sequence[str] = tuple(GROUPS)
    ):
        self._device_env: Any = env.unwrapped
        first = self._device_env.infants[0]
        groups = [name for name in checked_groups(movement) if bind_group(name, first).moment is None]
        self._infants = [DeviceInfant(self._device_env, world) for world in range(self._device_env.num_envs)]
        infants: Any = self._infants
        super().__init__(env, Recording(infants, folder, part_rows=part_rows, movement=groups, note=NOTE))
        self._ended = np.zeros(len(self._infants), bool)
        self._begun = False
        self._fields: dict[str, npt.NDArray[Any]] = {}
        self._time_s = np.zeros(len(self._infants))

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start episodes; see the environment."""
        observed, info = self.env.reset(seed=seed, options=options)
        count, observation = len(self._infants), _arrays(observed)
        seeds, given = seeds_of(seed, count), options_of(options or {}, count)
        self._look()
        for world in reset_indices(options or {}, count) or ():
            self._begin(world, observation, _info_of(info, world), seeds[world], given[world])
        self._begun = True
        return observed, info

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Make a control step; see the environment."""
        mode, ended = self._device_env.autoreset_mode, self._ended.copy()
        result = self.env.step(actions)
        if self._begun:
            observed, rewards, terminated, truncated, info = result
            observation, judged = _arrays(observed), [_array(part) for part in (rewards, terminated, truncated)]
            info, given = _arrays(info), _array(actions)
            last = info.get("final_obs", {})
            self._look()
            self._ended = (judged[1] | judged[2]).astype(bool)
            for world, infant in enumerate(self._infants):
                of_world = _info_of(info, world)
                if ended[world] and mode == AutoresetMode.NEXT_STEP:
                    self._begin(world, observation, of_world, None, {})
                    continue
                over = self._ended[world] and mode == AutoresetMode.SAME_STEP
                self._place(world, last if over else observation)
                infant.observer.stepping()
                reward, is_terminated, is_truncated = (part[world].item() for part in judged)
                infant.observer.stepped(given[world], infant.seen, (reward, is_terminated, is_truncated, of_world))
                if over:
                    self._begin(world, observation, of_world, None, {})
        return result

    def grow(self, to: Any) -> Any:
        """Let infants grow; see the environment."""
        before = [infant.age_months for infant in self._infants]
        observed = self.env.unwrapped.grow(to)
        for infant, former in zip(self._infants, before, strict=True):
            if infant.age_months != former:
                infant.observer.grew(infant.age_months)
        return observed

    def set_arousal(self, levels: Any) -> None:
        """Change arousals; see the environment."""
        self.env.unwrapped.set_arousal(levels)
        for infant, level in zip(self._infants, np.broadcast_to(_array(levels), len(self._infants)), strict=True):
            infant.observer.aroused(float(level))

    def set_state(self, states: Any) -> Any:
        """Restore states, from which other episodes begin; see the environment."""
        observed = self.env.unwrapped.set_state(states)
        self._look()
        for world, infant in enumerate(self._infants):
            infant.observer.restored()
            self._place(world, _arrays(observed))
        self._ended[:], self._begun = False, True
        return observed

    def _look(self) -> None:
        data = self._device_env.worlds.data
        self._fields = {name: getattr(data, name).numpy() for name in FIELDS}
        self._time_s = data.time.numpy()

    def _place(self, world: int, observation: Mapping[str, npt.NDArray[Any]]) -> None:
        """Let the infant that stands for a world be where that is, and observe what is observed there."""
        infant = self._infants[world]
        infant.seen = {name: readings[world] for name, readings in observation.items()}
        infant.data.time = float(self._time_s[world])
        for name, array in self._fields.items():
            field = getattr(infant.data, name)
            field[...] = array[world].reshape(field.shape)

    def _begin(
        self, world: int, observation: Mapping[str, Any], info: Mapping[str, Any], seed: int | None, options: Any
    ) -> None:
        infant: Any = self._infants[world]
        self._place(world, observation)
        mujoco.mj_forward(infant.model, infant.data)  # After a reset, a device has computed nothing of this yet.
        infant.observer.resetting()
        infant.observer.was_reset(seed, options, infant.seen, {name: info[name] for name in (AGE,) if name in info})


def _array(values: Any) -> npt.NDArray[Any]:
    if hasattr(values, "numpy") and not isinstance(values, np.ndarray):
        values = (values.cpu() if hasattr(values, "cpu") else values).numpy()
    return np.array(values)


def _arrays(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _arrays(item) if isinstance(item, Mapping) else _array(item) for name, item in values.items()}


LEFT_OUT = ("final_obs", "overflowed")
"""What an info says besides that of a single infant."""


def _info_of(info: Mapping[str, Any], world: int) -> dict[str, Any]:
    return {
        name: _info_of(values, world) if isinstance(values, Mapping) else _array(values)[world].item()
        for name, values in info.items()
        if not name.startswith("_") and name not in LEFT_OUT
    }
