"""Recording of everything that infants do and sense, of one environment or of many."""

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any

from mimoc.base.errors import RecordingError
from mimoc.bundle import files
from mimoc.recording.dictionary import write_dictionary
from mimoc.recording.folder import EPISODES, open_folder, versions
from mimoc.recording.movement_columns import GROUPS, checked_groups
from mimoc.recording.observer import RecordedSimulation, RecordingObserver, Writer, spaces_of
from mimoc.recording.video import require_av
from mimoc.runtime.custom_sense import CustomSense
from mimoc.runtime.infant import Infant
from mimoc.runtime.observer import NO_OBSERVER
from mimoc.runtime.task import CustomTask

PART_ROWS = 1000
"""Control steps in a part of an episode: what a kill can lose."""
LEAST_ROWS = 16
STATES_EVERY = 1000
"""Control steps from one complete state to the next."""
MOVEMENT_BYTES = 2**13
"""Of what movement columns need of a row: 4 to 10 kB."""
ROOM_BYTES = 2**28
"""Memory for what is not yet written of all infants together."""


class Recording(AbstractContextManager):
    """Records the episodes of some infants, and of all that share a world with them, in a folder until it is closed."""

    def __init__(
        self,
        infants: Sequence[Infant],
        folder: str | Path,
        *,
        states_every: int = STATES_EVERY,
        part_rows: int = PART_ROWS,
        movement: Sequence[str] = tuple(GROUPS),
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
        """Close it; after Ctrl-C or any other error, what was recorded so far is kept."""
        self.close()

    def _begun(self, part_rows: int, states_every: int) -> list[RecordedSimulation]:
        """Give each infant its observer, with parts of as many rows as the memory suffices for."""
        software, folder = versions(), self._folder
        pairs = zip(self._simulations, self._next_numbers(), strict=True)
        recorded = [RecordedSimulation(simulation, first) for simulation, first in pairs]
        shared = {id(one.simulation): one for one in recorded}
        for number, (infant, about) in enumerate(zip(self._infants, folder.description.infants, strict=True)):
            said = {"infant": number, "bundle": about.bundle, "versions": software, "objects": _objects(infant)}
            row_bytes = MOVEMENT_BYTES + sum(
                math.prod(space.shape) * space.dtype.itemsize for space in spaces_of(infant).values()
            )
            rows = min(part_rows, max(LEAST_ROWS, ROOM_BYTES // (len(self._infants) * row_bytes)))
            stem_of, one = partial(folder.stem, number), shared[id(infant.simulation)]
            infant.observer = RecordingObserver(
                infant, one, self._writer, stem_of, rows, states_every, said, self._movement
            )
        return recorded

    def _next_numbers(self) -> list[int]:
        numbers, description = self._folder.next_numbers(), self._folder.description
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
