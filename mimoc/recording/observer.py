"""The observer of one infant whose episodes are recorded, and the thread that writes them meanwhile."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from queue import Queue
from threading import Thread
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from mimoc.base.quantity import Quantity
from mimoc.bundle.model import physics_of
from mimoc.recording import tables
from mimoc.recording.columns import Block, Described, reading_of
from mimoc.recording.description import to_plain
from mimoc.recording.folder import TABLE, part_stem, with_extension, write_json
from mimoc.recording.movement_columns import MovementReader
from mimoc.recording.video import PICTURES_SUFFIX, write_pictures
from mimoc.runtime.infant import Infant, Observer
from mimoc.runtime.quantities import StepMeasures
from mimoc.runtime.sense import Observation
from mimoc.runtime.simulation import INFANTS, Simulation

Job = Callable[[], None]
WAITING = 4  # Jobs that wait at most; who brings another one waits as well, so that memory does not grow.


class Writer:
    """Does jobs one after the other in a thread of its own; after one has failed, none is done any more.

    A forked process has no such thread, and writes nothing into the recording of the process that it comes from.
    """

    def __init__(self) -> None:
        self._jobs: Queue[Job | None] = Queue(WAITING)
        self._error: BaseException | None = None
        self._thread = Thread(target=self._work, name="mimoc recording", daemon=True)
        self._thread.start()

    def __call__(self, job: Job) -> None:
        """Have a job done, unless this process is a fork; raise what one of the jobs before has raised."""
        self._check()
        if self._thread.is_alive():
            self._jobs.put(job)

    def drain(self) -> None:
        """Wait until all jobs are done; raise what one of them has raised."""
        if self._thread.is_alive():
            self._jobs.join()
        self._check()

    def close(self) -> None:
        """Do what is left, and end the thread, also twice; raise what one of the jobs has raised."""
        if self._thread.is_alive():
            self._jobs.put(None)
            self._thread.join()
        self._check()

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            if self._error is None:
                try:
                    job()
                except BaseException as error:
                    self._error = error
            self._jobs.task_done()

    def _check(self) -> None:
        if self._error is not None:
            raise self._error


NOTHING_YET = 0.0, False, False  # Reward, terminated and truncated of what is observed before the first step.
ACTION = "float32"  # Type of actions, unless a change says otherwise.
SINCE_RESET = ("physics", "signals", "steps")  # Parts of a state that a reset makes anew, and that it needs not know.
RANDOM = ("random", "noise")
"""Parts that a reset with a seed makes anew as well: before the first one they differ each time."""


def lasting(state: Mapping[str, Any], seeded: bool) -> dict[str, Any]:
    """Return the parts of a state that a reset, with a seed or without, goes on from."""
    left_out = SINCE_RESET + (RANDOM if seeded else ())
    kept = {name: part for name, part in state.items() if name not in left_out}
    if INFANTS in kept:
        kept[INFANTS] = {name: lasting(of_infant, seeded) for name, of_infant in kept[INFANTS].items()}
    return kept


@dataclass
class _Episode:
    """An episode that is being recorded."""

    number: int
    head: dict[str, Any]  # What its sidecar says once.
    block: Block
    action_dtype: np.dtype[Any] = field(default_factory=lambda: np.dtype(ACTION))
    """Type of the latest action: they are written in double precision."""
    steps: int = 0
    parts: int = 0
    changes: list[dict[str, Any]] = field(default_factory=list)
    states: list[dict[str, Any]] = field(default_factory=list)


@dataclass
class RecordedSimulation:
    """A simulation that is being recorded: what its infants, one or several, have in common."""

    simulation: Simulation
    next_number: int  # Number of the next episode, which is that of all infants.
    observers: list["RecordingObserver"] = field(default_factory=list)
    number: int = 0
    before: dict[str, Any] = field(default_factory=dict)
    physics: bytes = b""  # Physics after the latest control step.
    orders: dict[int, int] = field(default_factory=dict)
    """How many of the orders that each companion has before a control step are kept, by the companion's identity."""

    @property
    def has_states(self) -> bool:
        """Whether states are recorded: of what is simulated on the CPU."""
        return isinstance(self.simulation, Simulation)

    @property
    def keeper(self) -> "RecordingObserver | None":
        """The first infant whose episode goes on: it keeps states, and what is done besides control steps."""
        return next((observer for observer in self.observers if observer.is_on), None)

    def begin(self) -> None:
        """Begin an episode, which each infant joins."""
        self.number = self.next_number
        self.next_number = self.next_number + 1

    def end(self, how: str) -> None:
        """End the episodes of all infants."""
        for observer in self.observers:
            observer.end(how)

    def know_orders(self) -> None:
        """Take all orders of companions so far as kept, by a state."""
        companions = (one for observer in self.observers for one in observer.infant.companions.values())
        self.orders = {id(companion): len(companion.orders) for companion in companions}


class RecordingObserver(Observer):
    """Writes down the episodes of one infant."""

    keeps = True

    def __init__(
        self,
        infant: Infant,
        shared: RecordedSimulation,
        writer: Writer,
        stem_of: Callable[[int], Path],
        part_rows: int,
        states_every: int,
        about: Mapping[str, Any],
        movement: Sequence[str],
    ):
        self.infant, self._shared, self._writer, self._stem_of = infant, shared, writer, stem_of
        self._part_rows = part_rows
        self._states_every = states_every
        self._about = dict(about)
        self._movement = MovementReader(infant, movement)
        self._episode: _Episode | None = None
        self._measures = StepMeasures(infant, "record")
        self._described = _described(infant, self._movement)
        shared.observers.append(self)

    @property
    def is_on(self) -> bool:
        """Whether an episode is being recorded."""
        return self._episode is not None

    @property
    def movement_columns(self) -> tuple[Quantity, ...]:
        """The movement columns that are kept."""
        return self._movement.columns

    def resetting(self) -> None:
        """Keep what a reset goes on from: random numbers, noise, and what earlier episodes have left in the model."""
        shared = self._shared
        if self is shared.observers[0]:
            shared.before = self.infant.get_state()
            shared.end("reset")
            shared.begin()

    def was_reset(
        self, seed: int | None, options: Mapping[str, Any], observation: Observation, info: Mapping[str, Any]
    ) -> None:
        """Begin an episode."""
        shared = self._shared
        reset = {"seed": seed, "options": dict(options), "before": {}}
        if self is shared.observers[0]:
            reset["before"] = lasting(shared.before, seed is not None)
        self._begin(reset, observation, info)

    def stepping(self) -> None:
        """Keep the physics if it was changed from outside; begin an episode here if there is none."""
        shared, infant = self._shared, self.infant
        if self._episode is None:
            if shared.keeper is None:
                shared.begin()
            self._begin(None, infant.observe(), {})
            if self is shared.keeper:
                shared.know_orders()
        elif self is shared.keeper and shared.has_states and shared.physics != self._physics_now():
            self._change("physics", physics_of(infant.model, infant.data))
        if infant.companions:
            for name, companion in infant.companions.items():
                for order in companion.orders[shared.orders.get(id(companion), 0) :]:
                    self._change("order", {"companion": name, "order": dict(order)})
                shared.orders[id(companion)] = len(companion.orders)

    def stepped(
        self, action: npt.NDArray[Any], observation: Observation, judged: tuple[float, bool, bool, Mapping[str, Any]]
    ) -> None:
        """Keep a control step; write a part of the episode if it is due, and the episode if it has ended."""
        episode, is_keeper = self._episode, self is self._shared.keeper
        assert episode is not None
        action = np.asarray(action)
        if action.dtype != episode.action_dtype:
            episode.action_dtype = action.dtype
            self._change("action_dtype", action.dtype.name)
        episode.steps += 1
        if episode.block.is_full:
            self._write_part(episode)
            episode.block = self._new_block(episode.steps)
        self._put(episode.block, action, judged, observation)
        if self._shared.has_states:
            episode.block.put_measures(self._measures.read(judged[3]))
        if is_keeper and self._shared.has_states:
            self._shared.physics = self._physics_now()
            self._shared.orders = {}
            if episode.steps % self._states_every == 0:
                episode.states.append({"step": episode.steps, "state": self.infant.get_state()})
        if judged[1] or judged[2]:
            self.end("terminated" if judged[1] else "truncated")

    def grew(self, to: float) -> None:
        """Keep an age, and what the infant was made of it."""
        self._change("age_months", to)

    def restored(self) -> None:
        """Keep a state that was restored; in a world, where it says whose episodes go on, it begins an episode."""
        shared = self._shared
        if len(shared.observers) > 1:
            shared.end("reset")
        else:
            self._change("state", self.infant.get_state())
        shared.know_orders()

    def expressed(self, expression: str) -> None:
        """Keep an expression."""
        self._change("expression", expression)

    def aroused(self, level: float) -> None:
        """Keep an arousal."""
        self._change("arousal", level)

    def end(self, how: str) -> None:
        """End the episode that is being recorded, if there is one."""
        if self._episode is not None:
            self._write_part(self._episode, ended=how)
            self._episode = None

    def _begin(self, reset: Mapping[str, Any] | None, observation: Observation, info: Mapping[str, Any]) -> None:
        keeps = self._shared.keeper is None
        head = {**self._about, "reset": reset, "start": self.infant.get_state() if keeps else {}}
        self._episode = _Episode(self._shared.number, head, self._new_block(0))
        self._put(self._episode.block, None, (*NOTHING_YET, info), observation)
        if keeps:
            self._shared.physics = self._physics_now()

    def _put(self, block: Block, action: Any, judged: Any, observation: Observation) -> None:
        block.put(self.infant.data.time, action, judged, observation)
        if self._movement.columns:
            self._movement.add(block.movement, block.room)

    def _new_block(self, first_step: int) -> Block:
        return Block(self._described.readings, len(self._described.actions), self._part_rows, first_step)

    def _write_part(self, episode: _Episode, **ended: str) -> None:
        sidecar = {"changes": episode.changes, "states": episode.states, "rows": episode.block.rows, **ended}
        sidecar |= {} if episode.parts else episode.head
        stem = part_stem(self._stem_of(episode.number), episode.parts)
        self._writer(partial(_write, stem, episode.block, self._described, sidecar))
        episode.parts = episode.parts + 1
        episode.changes = []
        episode.states = []

    def _change(self, what: str, value: Any) -> None:
        keeper = self._shared.keeper
        if keeper is None or keeper._episode is None:
            return
        whose = {"infant": self._about["infant"]} if len(self._shared.observers) > 1 else {}
        step = (self._episode or keeper._episode).steps
        keeper._episode.changes.append({"step": step, what: value, **whose})
        if what in ("age_months", "state"):
            self._shared.physics = self._physics_now()

    def _physics_now(self) -> bytes:
        return physics_of(self.infant.model, self.infant.data).tobytes()


def _write(stem: Path, block: Block, described: Described, sidecar: Mapping[str, Any]) -> None:
    """Write some rows of an episode; without the sidecar, which comes last, the rest counts for nothing.

    States become text here, and movement columns are computed, in the writer's thread.
    """
    for reading in described.readings:
        if reading.kind == "picture":
            pictures = block.dense[reading.name][: block.rows]
            path = with_extension(stem, f".{reading.name}{PICTURES_SUFFIX}")
            write_pictures(path, pictures, described.rate_hz)
    tables.write_block(with_extension(stem, TABLE), block, described)
    write_json(with_extension(stem, ".json"), {name: to_plain(value) for name, value in sidecar.items()})


def _described(infant: Infant, movement: MovementReader) -> Described:
    layouts: dict[str, Sequence[str]] = {}
    for name, sense in infant.senses.items():
        layouts |= dict.fromkeys(sense.spaces, infant.layout(name))
    observation = infant.observe()
    readings = tuple(reading_of(name, np.asarray(array), layouts.get(name, ())) for name, array in observation.items())
    actuators = infant.manifest.commands
    columns = [tuple(column.name for column in kind) for kind in (movement.numbers, movement.texts)]
    return Described(readings, actuators, infant.manifest.step_ms, *columns)


def spaces_of(infant: Infant) -> Mapping[str, Any]:
    """Return the space of each array of what an infant observes, by name."""
    return cast("Any", infant.observation_space).spaces
