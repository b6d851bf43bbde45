"""Recording of everything that infants do and sense, of one environment or of many."""

import math
import warnings
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

import gymnasium
from gymnasium.vector import VectorEnv, VectorWrapper

from mimoc.bundle import files
from mimoc.errors import RecordingError
from mimoc.recording import episode_writer
from mimoc.recording.description import UNFINISHED
from mimoc.recording.folder import EPISODES, RecordingFolder, digest, open_folder, versions
from mimoc.recording.infant_journal import InfantJournal, Pace
from mimoc.recording.video import require_av
from mimoc.recording.writer import Writer
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.journal import UNTOLD
from mimoc.runtime.many.vector_env import ManyInfants
from mimoc.senses.custom import CustomSense
from mimoc.tasks.binding import CustomTask

PART_ROWS = 500
"""Control steps in a part of an episode: what a kill can lose."""
LEAST_ROWS = 16
STATES_EVERY = 1000
"""Control steps from one complete state to the next."""
ROOM_BYTES = 2**28
"""Memory for what is not yet written of all infants together."""


class Recording:
    """Records the episodes of some infants in a folder until it is closed."""

    def __init__(
        self,
        infants: Sequence[InfantEnv],
        folder: str | Path,
        *,
        states_every: int = STATES_EVERY,
        part_rows: int = PART_ROWS,
    ):
        """Begin to record; see `Recorder`."""
        for infant in infants:
            if infant.journal is not UNTOLD:
                raise RecordingError("this infant is being recorded already; close that recording first")
        if any(space.dtype == "uint8" for infant in infants for space in _spaces(infant)):
            require_av()
        bundles = [infant.bundle for infant in infants]
        self._infants = tuple(infants)
        self._folder = open_folder(folder, bundles, step_ms=infants[0].manifest.step_ms)
        try:
            _tidy(self._folder)
            self._writer = Writer()
            self._journals = self._begun(Pace(part_rows, states_every), [digest(bundle) for bundle in bundles])
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
        return tuple(dict.fromkeys(note for infant in self._infants for note in _notes_on(infant)))

    def wait(self) -> None:
        """Wait until what was handed over to be written is written.

        Raises:
            OutputError: If something could not be written.
        """
        self._writer.drain()

    def mark(self, run: str, steps: int) -> None:
        """End all episodes here, and remove what the same run has recorded beyond this place before.

        Args:
            run: Name of the run, from which follows what it does.
            steps: How far it is.

        Raises:
            OutputError: If the folder cannot be written.
        """
        for journal in self._journals:
            journal.end("reset")
        self._writer.drain()
        self._folder.mark(run, steps)
        for journal, number in zip(self._journals, self._folder.next_numbers(), strict=True):
            journal.go_on_from(number)

    def close(self) -> None:
        """Write what is left, and record no more; closing twice is fine.

        Raises:
            OutputError: If something could not be written.
        """
        if all(infant.journal is UNTOLD for infant in self._infants):
            return
        for infant in self._infants:
            infant.journal = UNTOLD
        try:
            for journal in self._journals:
                journal.end("closed")
            self._writer.close()
        finally:
            self._folder.close()

    def __enter__(self) -> "Recording":
        """Return itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: Any) -> None:
        """Close it; after Ctrl-C or any other error, what was recorded so far is kept."""
        self.close()

    def _begun(self, pace: Pace, digests: Sequence[str]) -> list[InfantJournal]:
        """Give each infant its journal."""
        here, journals, folder = versions(), [], self._folder
        for number, (infant, first) in enumerate(zip(self._infants, folder.next_numbers(), strict=True)):
            about = {"infant": number, "bundle": digests[number], "versions": here, "objects": _objects(infant)}
            stem_of = partial(folder.stem, number)
            journal = InfantJournal(infant, self._writer, stem_of, first, _fitting(pace, infant, len(digests)), about)
            infant.journal = journal
            journals.append(journal)
        return journals


class EnvRecorder(gymnasium.Wrapper[Any, Any, Any, Any]):
    """The environment of one infant whose episodes are recorded."""

    def __init__(self, env: gymnasium.Env[Any, Any], recording: Recording):
        """Wrap an environment whose infant is being recorded."""
        super().__init__(env)
        self.recording = recording

    def close(self) -> None:
        """End the recording, and close the environment."""
        try:
            self.recording.close()
        finally:
            super().close()

    def __enter__(self) -> "EnvRecorder":
        """Return itself."""
        return self

    def __exit__(self, *error: Any) -> Literal[False]:
        """Close it."""
        self.close()
        return False


class VectorRecorder(VectorWrapper):
    """A vector environment whose infants' episodes are recorded."""

    def __init__(self, env: VectorEnv[Any, Any, Any], recording: Recording):
        """Wrap a vector environment whose infants are being recorded."""
        super().__init__(env)
        self.recording = recording

    def close(self, **options: Any) -> None:
        """End the recording, and close the environment."""
        try:
            self.recording.close()
        finally:
            super().close(**options)

    def __enter__(self) -> "VectorRecorder":
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()


def Recorder(  # noqa: N802 - It stands for the classes above.
    env: Any, folder: str | Path, *, states_every: int = STATES_EVERY, part_rows: int = PART_ROWS
) -> Any:
    """Record every episode of an environment from now on, and return it in a wrapper that ends this when it is closed.

        with mimoc.Recorder(mimoc.make("configs/reach.yaml"), "recordings/reach") as env:
            observation, info = env.reset(seed=0)

    What is recorded is what the infant itself does and senses, whatever wrappers are around it or are put around it
    later. `mimoc.read_recording` reads it, and `mimoc replay` does everything again and compares. Its place in the
    stack of wrappers does not matter, but it must be closed: until then, the latest steps are only in memory.

    Args:
        env: An environment of mimoc's, or a vector environment of them on the CPU.
        folder: A new or empty folder, or that of a recording of the same infants, which is continued.
        states_every: Control steps from one complete state to the next.
        part_rows: Control steps after which what was recorded is written, which a kill can lose; fewer for large
            pictures.

    Raises:
        RecordingError: If this is no such environment, or the folder holds anything else.
        OutputError: If the folder cannot be written.
        MissingExtraError: If PyArrow, or for infants that see PyAV, is not installed.
    """
    for name, value in (("states_every", states_every), ("part_rows", part_rows)):
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise RecordingError(f"{name} must be a positive whole number, not {value!r}")
    recording = Recording(infants_of(env), folder, states_every=states_every, part_rows=part_rows)
    for note in recording.notes:
        warnings.warn(note, stacklevel=2)
    return VectorRecorder(env, recording) if isinstance(env, VectorEnv) else EnvRecorder(env, recording)


def infants_of(env: Any) -> tuple[InfantEnv, ...]:
    """Return the infants of an environment.

    Raises:
        RecordingError: If it has none in this process and on the CPU.
    """
    inside = getattr(env, "unwrapped", None)
    if isinstance(inside, InfantEnv):
        return (inside,)
    if isinstance(inside, ManyInfants):
        return inside.infants
    several = [each.unwrapped for each in getattr(inside, "envs", ())]
    if several and all(isinstance(each, InfantEnv) for each in several):
        return tuple(several)
    raise RecordingError(
        f"cannot record {type(inside or env).__name__}: give an environment of mimoc.make, or one of mimoc.make_vec on"
        " the CPU"
    )


def _tidy(folder: RecordingFolder) -> None:
    """Put together the episodes of a process that was killed, and remove what it had begun to write."""
    for leftover in (folder.path / EPISODES).glob(".mimoc-*.tmp"):
        files.discard(leftover)
    for episode in folder.episodes():
        if not episode.is_whole:
            episode_writer.finish(episode, UNFINISHED)


def _fitting(pace: Pace, infant: InfantEnv, infants: int) -> Pace:
    """Return a pace at which the memory suffices."""
    row_bytes = 1 + sum(math.prod(space.shape or ()) * space.dtype.itemsize for space in _spaces(infant))
    most = max(LEAST_ROWS, ROOM_BYTES // (infants * row_bytes))
    return Pace(min(pace.rows, most), pace.states_every)


def _spaces(infant: InfantEnv) -> list[Any]:
    spaces: Any = infant.observation_space
    return list(spaces.spaces.values())


def _notes_on(infant: InfantEnv) -> list[str]:
    """Return what of an infant cannot be made again from its bundle."""
    return [
        f"{what} is an object of a script's own ({name}), which no recording contains: pass an equal one to replay it"
        for what, name in _objects(infant).items()
    ]


def _objects(infant: InfantEnv) -> dict[str, str]:
    """Return the class of each object that a script has passed, by what it is."""
    objects = {f"senses.{name}": each for name, each in infant.senses.items() if isinstance(each, CustomSense)}
    task = {"task": infant.task} if isinstance(infant.task, CustomTask) else {}
    return {what: each.class_name for what, each in {**task, **objects}.items()}
