"""Wrappers of environments whose infants are being recorded, which end the recording when they are closed."""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
from gymnasium.vector import VectorEnv, VectorWrapper

from mimoc.base.errors import RecordingError
from mimoc.columns import GROUPS
from mimoc.recording.device import DeviceRecorder
from mimoc.recording.recorder import PART_ROWS, STATES_EVERY, Closing, Recording
from mimoc.runtime.batch.gymnasium_forms import InfantVectorEnv
from mimoc.runtime.batch.vector_env import BatchEnv
from mimoc.runtime.infants import infants_of


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
        """Return what the world has of this name."""
        if name.startswith("__") or name == "env":
            raise AttributeError(name)
        return getattr(self.env, name)


def Recorder(  # noqa: N802 - It stands for the classes above.
    env: Any,
    folder: str | Path,
    *,
    states_every: int = STATES_EVERY,
    part_rows: int = PART_ROWS,
    movement: Sequence[str] = tuple(GROUPS),
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
