"""Recording of everything that infants do and sense, of one environment or of many."""

import math
import warnings
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper

from mimoc.base.errors import RecordingError
from mimoc.bundle import files
from mimoc.recording.folder import EPISODES, open_folder, versions, write_dictionary
from mimoc.recording.movement_columns import checked_groups
from mimoc.recording.movement_groups import BIND
from mimoc.recording.observer import RecordedSimulation, RecordingObserver, Writer, spaces_of
from mimoc.recording.video import require_av
from mimoc.runtime.batch_env import BatchEnv, infants_of
from mimoc.runtime.gymnasium_forms import InfantVectorEnv, options_of, reset_indices, seeds_of
from mimoc.runtime.infant import AGE, NO_OBSERVER, Infant, Observer
from mimoc.runtime.sense import CustomSense, Observation
from mimoc.runtime.task import CustomTask
from mimoc.schema.kinds import MOVEMENT_GROUPS

PART_ROWS = 1000  # Control steps in a part of an episode: what a kill can lose.
MIN_ROWS = 16
STATES_EVERY = 1000  # Control steps from one complete state to the next.
MOVEMENT_BYTES = 2**13  # Assumed size of the movement columns of a row, which need 4 to 10 kB.
ROOM_BYTES = 2**28  # Memory for what is not yet written of all infants together.


class Recording(AbstractContextManager):
    """Records the episodes of some infants, and of all that share a world with them, in a folder until it is closed."""

    def __init__(
        self,
        infants: Sequence[Infant],
        folder: str | Path,
        *,
        states_every: int = STATES_EVERY,
        part_rows: int = PART_ROWS,
        movement: Sequence[str] = tuple(MOVEMENT_GROUPS),
        note: str | None = None,
    ):
        """Begin to record; see `Recorder`; *note* says why this cannot be replayed, if it cannot."""
        self._movement = checked_groups(movement)
        self._simulations = [*{id(infant.simulation): infant.simulation for infant in infants}.values()]
        infants = self._infants = tuple(one for each in self._simulations for one in each.infants.values())
        for infant in infants:
            if infant.observer is not NO_OBSERVER:
                raise RecordingError("this infant is being recorded already; close that recording first")
        if any(space.dtype == "uint8" for infant in infants for space in spaces_of(infant).values()):
            require_av()
        self._folder = open_folder(folder, [simulation.bundle for simulation in self._simulations], note=note)
        try:
            for leftover in (self.path / EPISODES).glob(".mimoc-*.tmp"):
                files.discard(leftover)
            self._writer = Writer()
            self._recorded = self._begun(part_rows, states_every)
            self._observers = [observer for one in self._recorded for observer in one.observers]
            write_dictionary(
                self.path, [column for observer in self._observers for column in observer.movement_columns]
            )
        except BaseException:
            self._folder.close()
            raise

    @property
    def path(self) -> Path:
        """The folder."""
        return self._folder.path

    @property
    def notes(self) -> tuple[str, ...]:
        """What cannot be replayed without help, one line each."""
        objects = dict.fromkeys(item for infant in self._infants for item in _objects(infant).items())
        advice = "which no recording contains: pass an equal one to replay it"
        return tuple(f"{what} is an object of a script's own ({name}), {advice}" for what, name in objects)

    def wait(self) -> None:
        """Wait until what was handed over to be written is written, or raise an OutputError."""
        self._writer.drain()

    def mark(self, run: str, steps: int) -> None:
        """End all episodes here, and remove what a run of this name has recorded beyond so many steps before."""
        for observer in self._observers:
            observer.end("reset")
        self._writer.drain()
        self._folder.mark(run, steps)
        for one, number in zip(self._recorded, self._next_numbers(), strict=True):
            one.next_number = number

    def close(self) -> None:
        """Write what is left, or raise an OutputError, and record no more; closing twice is fine."""
        if all(infant.observer is NO_OBSERVER for infant in self._infants):
            return
        for infant in self._infants:
            infant.observer = NO_OBSERVER
        try:
            for observer in self._observers:
                observer.end("closed")
            self._writer.close()
        finally:
            self._folder.close()

    def __exit__(self, *error: object) -> None:
        self.close()

    def _begun(self, part_rows: int, states_every: int) -> list[RecordedSimulation]:
        software, folder = versions(), self._folder
        pairs = zip(self._simulations, self._next_numbers(), strict=True)
        recorded = [RecordedSimulation(simulation, first) for simulation, first in pairs]
        shared = {id(one.simulation): one for one in recorded}
        for number, (infant, about) in enumerate(zip(self._infants, folder.description.infants, strict=True)):
            said = {"infant": number, "bundle": about.bundle, "versions": software, "objects": _objects(infant)}
            row_bytes = MOVEMENT_BYTES + sum(
                math.prod(space.shape) * space.dtype.itemsize for space in spaces_of(infant).values()
            )
            rows = min(part_rows, max(MIN_ROWS, ROOM_BYTES // (len(self._infants) * row_bytes)))
            stem_of = partial(folder.stem, number)
            one = shared[id(infant.simulation)]
            infant.observer = RecordingObserver(
                infant, one, self._writer, stem_of, rows, states_every, said, self._movement
            )
        return recorded

    def _next_numbers(self) -> list[int]:
        numbers = self._folder.next_numbers()
        description = self._folder.description
        firsts = dict.fromkeys(description.sharing(infant) for infant in range(len(numbers)))
        return [max(numbers[infant] for infant in sharing) for sharing in firsts]


class Closing(AbstractContextManager):
    """What all wrappers do: they end the recording before they close what they wrap."""

    env: Any

    def __init__(self, env: Any, recording: Recording):
        super().__init__(env)  # pyright: ignore[reportCallIssue] - That of Gymnasium's wrapper.
        self.recording = recording

    def close(self, **options: Any) -> None:
        """End the recording, and close the environment."""
        try:
            self.recording.close()
        finally:
            self.env.close(**options)

    def __exit__(self, *error: object) -> None:
        self.close()


def _objects(infant: Infant) -> dict[str, str]:
    objects = {f"senses.{name}": item for name, item in infant.senses.items() if isinstance(item, CustomSense)}
    classes = {name: type(infant.companions[name]) for name in sorted(infant.companions.custom)}
    companions = {f"companions.{name}": f"{kind.__module__}:{kind.__qualname__}" for name, kind in classes.items()}
    task = {"task": infant.task} if isinstance(infant.task, CustomTask) else {}
    return {what: item.class_name for what, item in {**task, **objects}.items()} | companions


class EnvRecorder(Closing, gymnasium.Wrapper[Any, Any, Any, Any]):
    """The environment of one infant whose episodes are recorded."""


class VectorRecorder(Closing, VectorWrapper):
    """A vector environment whose infants' episodes are recorded."""


class WorldRecorder(Closing):
    """A world whose infants' episodes are recorded: all else is the world's."""

    def __init__(self, env: Any, recording: Recording):
        self.env, self.recording = env, recording

    @property
    def unwrapped(self) -> Any:
        """The world."""
        return getattr(self.env, "unwrapped", self.env)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "env":
            raise AttributeError(name)
        return getattr(self.env, name)


def Recorder(  # noqa: N802 - It stands for the classes above.
    env: Any,
    folder: str | Path,
    *,
    states_every: int = STATES_EVERY,
    part_rows: int = PART_ROWS,
    movement: Sequence[str] = tuple(MOVEMENT_GROUPS),
) -> Any:
    """Record every episode of an environment from now on, and return it in a wrapper that ends this when it is closed.

    What is recorded is what the infant itself does and senses, whatever wrappers are around it or are put around it
    later. `mimoc.read_recording` reads it, and `mimoc replay` does everything again and compares. Its place in the
    stack of wrappers does not matter, but it must be closed: until then, the latest steps are only in memory. On a
    device, what is done by this wrapper is recorded, from the first reset on, without states: it cannot be replayed.

    Args:
        env: Any environment of mimoc's: of one infant, of a world of several, or a vector environment.
        folder: A new or empty folder, or that of a recording of the same infants, which is continued.
        states_every: Control steps from one complete state to the next.
        part_rows: Control steps after which what was recorded is written, which a kill can lose; fewer for large
            pictures.
        movement: Groups of movement columns: `keypoints`, `parts`, `gaze`, `contacts`, `joints`, `actuators`; by
            default all, `()` for none.

    Raises:
        UnknownNameError: If there is no such group.
        RecordingError: If the folder holds anything else, or an infant is recorded already.
        OutputError: If the folder cannot be written.
        MissingExtraError: If PyArrow, or for infants that see PyAV, is not installed.
        TypeError: If this is no such environment.

    Example:
        >>> import mimoc
        >>> with mimoc.Recorder(mimoc.make("nine_months.yaml"), "recordings/recorder") as env:
        ...     observation, info = env.reset(seed=0)
        ...     for _ in range(2):
        ...         _ = env.step(env.action_space.sample())
        >>> mimoc.read_recording("recordings/recorder")[0].actions.shape
        (2, 44)
    """
    for name, value in (("states_every", states_every), ("part_rows", part_rows)):
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise RecordingError(f"{name} must be a positive whole number, not {value!r}")
    inside = getattr(env, "unwrapped", env)
    if isinstance(inside, InfantVectorEnv) and not isinstance(inside, BatchEnv):
        return DeviceRecorder(env, folder, part_rows=part_rows, movement=movement)
    infants = [*infants_of("Recorder", env).values()]
    recording = Recording(infants, folder, states_every=states_every, part_rows=part_rows, movement=movement)
    for note in recording.notes:
        warnings.warn(note, stacklevel=2)
    wrappers = {VectorEnv: VectorRecorder, gymnasium.Env: EnvRecorder}
    return next((wrap for kind, wrap in wrappers.items() if isinstance(env, kind)), WorldRecorder)(env, recording)


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
        self.infants = {"": self}
        self.simulation = self
        self.observation_space = env.single_observation_space
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
        self,
        env: Any,
        folder: str | Path,
        *,
        part_rows: int = PART_ROWS,
        movement: Sequence[str] = tuple(MOVEMENT_GROUPS),
    ):
        self._device_env: Any = env.unwrapped
        first = self._device_env.infants[0]
        groups = [name for name in checked_groups(movement) if BIND[name](first).moment is None]
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
        seeds = seeds_of(seed, count)
        given = options_of(options or {}, count)
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
            observation = _arrays(observed)
            judged = [_array(part) for part in (rewards, terminated, truncated)]
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


LEFT_OUT = ("final_obs", "overflowed")  # What an info says besides that of a single infant.


def _info_of(info: Mapping[str, Any], world: int) -> dict[str, Any]:
    return {
        name: _info_of(values, world) if isinstance(values, Mapping) else _array(values)[world].item()
        for name, values in info.items()
        if not name.startswith("_") and name not in LEFT_OUT
    }
