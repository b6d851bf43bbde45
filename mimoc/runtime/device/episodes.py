"""Episodes on a device: a table of starts of each infant, which single environments have drawn; rewards, and ends."""

import json
from collections.abc import Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode

from mimoc.runtime.arousal import Arousal
from mimoc.runtime.device.arrays import put, where_worlds
from mimoc.runtime.device.bodies import BATCHED
from mimoc.runtime.device.capacity import is_losing, report
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.model_fields import Constraints, rows_by_name
from mimoc.runtime.objects import Objects
from mimoc.runtime.sense import NOTHING, IntArray
from mimoc.runtime.task import FORCES, NO_REWARD, Change, CustomTask, Judgement, Task, check_term_judgement
from mimoc.runtime.term import Term, differing_field, stack_terms
from mimoc.runtime.worlds import Worlds

VISION = "vision"
STATE = ("qpos", "qvel", "act", "ctrl", "qacc_warmstart", FORCES)  # Fields that an episode begins with.
Start = tuple[dict[str, Any], dict[str, Any], dict[str, Any]]
"""Fields, what the task remembers, and samples at a start."""
StartOptions = str  # Options of a reset that decide on starts, `pose` and `objects`, as JSON with sorted keys.
AS_BUILT: StartOptions = "{}"
BITS_32 = 2**32 - 1


class Table(NamedTuple):
    """Values of a field at each start."""

    values: torch.Tensor  # Shape (starts, rows, ...).
    rows: Any = ...  # Which rows of a world's numbers these are; by default, all.

    def write(self, start: torch.Tensor, array: torch.Tensor) -> None:
        """Write to the worlds that begin with a start, shape (worlds,); -1 is none."""
        array[:, self.rows] = where_worlds(start >= 0, self.values[start.clamp(min=0)], array[:, self.rows])


@dataclass(frozen=True, slots=True)
class InitialStates:
    """The starts of all bodies with the same options; those of a body are contiguous."""

    first: torch.Tensor  # The first one of the body in each world, shape (worlds,).
    count: torch.Tensor  # How many that body has, shape (worlds,).
    fields: Mapping[str, Table]  # Fields of the state, and of the model where episodes change them.
    memory: Mapping[str, Table]
    samples: dict[str, torch.Tensor]  # What each sense measures at the start, shape (starts, n).

    def restore(
        self, start: torch.Tensor, model: mjw.Model, data: mjw.Data, memory: Mapping[str, torch.Tensor] = NOTHING
    ) -> None:
        """Put worlds into their starts, shape (worlds,); -1 leaves a world as it is."""
        for name, table in self.fields.items():
            table.write(start, _field(name, model, data))
        for name, values in memory.items():
            self.memory[name].write(start, values)

    def draw(self, seeds: torch.Tensor, episodes: torch.Tensor) -> torch.Tensor:
        """Draw a start for each world, which depends on its seed and the number of its episode alone."""
        return self.first + _hash(_hash(seeds.long()) + episodes) % self.count


def _hash(numbers: torch.Tensor) -> torch.Tensor:
    """Hash whole numbers to 32 bits by RXS-M-XS of PCG (O'Neill 2014)."""
    state = (numbers * 747796405 + 2891336453) & BITS_32
    word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) & BITS_32
    return (word >> 22) ^ word


def changed_rows(infant: InfantEnv) -> dict[str, IntArray]:
    """Return the rows of model fields that an infant's episodes change, by field, if MuJoCo Warp reads it."""
    constraints = Constraints(infant.manifest.constraints, infant.model)
    objects = Objects(infant.manifest, infant.model)
    rows = rows_by_name([*constraints.model_fields, *infant.task.model_fields, *objects.model_fields])
    return {name: rows[name] for name in rows.keys() & BATCHED if len(rows[name])}


def changed_fields(infants: Sequence[InfantEnv]) -> set[str]:
    """Return the model fields that episodes change, arousal included."""
    aroused = {name for env in infants for name in Arousal(env.manifest.actuation, env.model).fields}
    return aroused | {name for infant in infants for name in changed_rows(infant)}


def sample_initial_states(
    infants: Sequence[InfantEnv],
    body: torch.Tensor,
    most: int,
    options: StartOptions,
    readers: Mapping[str, Any],
    model: mjw.Model,
    data: mjw.Data,
    drawn: MutableMapping[InfantEnv, dict[StartOptions, list[Start]]],
) -> InitialStates:
    """Return the starts of all infants with some options of a reset.

    Start k of an infant is that of a single environment with seed k; an infant whose starts are not random has one.
    """
    rows = changed_rows(infants[0])
    for infant in infants:
        if options not in drawn.setdefault(infant, {}):
            drawn[infant][options] = _starts(infant, most, options, rows, readers)
    starts = [drawn[infant][options] for infant in infants]
    counts = [len(of_infant) for of_infant in starts]
    fields, memory, samples = (
        {name: put(np.stack([part[name] for part in parts])) for name in parts[0]}
        for parts in zip(*(start for of_infant in starts for start in of_infant), strict=True)
    )
    tables = {name: Table(fields[name]) for name in STATE if fields[name].numel()}
    for name, which in rows.items():
        shape = len(fields[name]), len(which), *_field(name, model, data).shape[2:]
        tables[name] = Table(fields[name].reshape(shape), put(which))
    first = put(np.cumsum([0, *counts[:-1]]))[body]
    count = put(counts)[body]
    initial = InitialStates(first, count, tables, {name: Table(values) for name, values in memory.items()}, samples)
    if VISION in readers:
        samples[VISION] = _seen_at(initial, readers[VISION], body, model, data)
    return initial


def _starts(
    infant: InfantEnv, most: int, options: StartOptions, rows: Mapping[str, IntArray], readers: Mapping[str, Any]
) -> list[Start]:
    """Return each start of an infant; noise is drawn later, in each episode."""
    starts: list[Start] = []
    for seed in range(most):
        infant.reset(seed=seed, options=json.loads(options))
        fields = {name: getattr(infant.data, name).copy() for name in STATE}
        fields |= {name: getattr(infant.model, name)[which] for name, which in rows.items()}
        senses = {name: sense for name, sense in infant.senses.items() if name != VISION}
        samples = {name: np.asarray(sense(infant.data), float).ravel() for name, sense in senses.items()}
        samples |= {name: read.start(samples[name]) for name, read in readers.items() if hasattr(read, "start")}
        starts.append((fields, infant.task.state, samples))
        if infant.np_random.bit_generator.state == seeding.np_random(seed)[0].bit_generator.state:
            break  # Nothing was drawn.
    infant.reset(seed=0)  # Its objects are where they were built.
    return starts


def _seen_at(starts: InitialStates, sight: Any, body: torch.Tensor, model: mjw.Model, data: mjw.Data) -> torch.Tensor:
    """Return what is seen at each start, shape (starts, n), in 8 bits.

    Each world shows starts of its own body, in turn with all others of that body, and is left as it was.
    """
    former = {name: _field(name, model, data).clone() for name in starts.fields}
    same = body[:, None] == body
    sharing, turn = same.sum(dim=1), same.tril(-1).sum(dim=1)
    total = int((starts.first + starts.count).max())
    seen: Any = None
    for earlier in range(int((starts.count / sharing).ceil().max())):
        start = starts.first + (turn + earlier * sharing) % starts.count
        starts.restore(start, model, data)
        mjw.kinematics(model, data)
        mjw.camlight(model, data)
        pictures = sight(data)
        seen = pictures.new_empty((total, pictures.shape[1])) if seen is None else seen
        seen[start] = pictures
    for name, values in former.items():
        _field(name, model, data).copy_(values)
    return seen


def _field(name: str, model: mjw.Model, data: mjw.Data) -> torch.Tensor:
    return wp.to_torch(getattr(data if name in STATE else model, name))


TOO_MUCH = 1e10  # Position, velocity or acceleration beyond which a simulation is unstable (MuJoCo's mjMAXVAL).
NEVER = 2**31 - 1


class EpisodeEnds:
    """Rewards and ends of each control step; arrays have the shape (worlds,)."""

    def __init__(self, infants: Sequence[InfantEnv], body: torch.Tensor, max_steps: int | None, mode: AutoresetMode):
        self._max_steps, self._mode = max_steps, mode
        self.limit(infants, body)
        self.steps, self.episode = torch.zeros_like(body), torch.zeros_like(body)
        self.ended = torch.zeros_like(body, dtype=torch.bool)  # Whether a new episode is due.
        self.report: torch.Tensor | None = None  # What the CPU reads of the last step; see `capacity.report`.

    def limit(self, infants: Sequence[InfantEnv], body: torch.Tensor) -> None:
        """Set the lengths of episodes to those of the body in each world, shape (worlds,)."""
        pairs = [(infant.max_steps, self._max_steps) for infant in infants]
        self.limits = put([min(NEVER if limit is None else limit for limit in pair) for pair in pairs])[body]

    def judge(
        self, judgement: Judgement, worlds: Worlds, actions: torch.Tensor, starts: InitialStates, seeds: torch.Tensor
    ) -> None:
        """Sum rewards, find which episodes end, and choose the next starts; actions have the shape (worlds, n)."""
        is_waiting = self.ended & (self._mode == AutoresetMode.NEXT_STEP)
        is_broken = ~(torch.cat([worlds.qpos, worlds.qvel, worlds.qacc], dim=1).abs() <= TOO_MUCH).all(dim=1)
        is_judged = ~is_broken & ~is_waiting
        self.terms = {name: torch.where(is_judged, term, 0.0) for name, term in judgement.reward_terms.items()}
        self.reward = sum(self.terms.values(), torch.zeros_like(worlds.qpos[:, 0]))
        self.success = is_judged & judgement.success
        self.unstable = is_broken & ~is_waiting
        self.overflowed = is_losing(worlds) & is_judged  # Whether contacts were lost.
        self.terminated = (is_judged & judgement.terminated) | self.unstable
        self.steps += 1
        self.truncated = ((self.steps >= self.limits) | self.overflowed) & ~is_waiting
        self.finished = self.truncated | self.terminated  # Whether an episode has ended in this very step.
        self.report = report(worlds, actions, self.reward, self.unstable, self.overflowed)
        in_same_step = self._mode == AutoresetMode.SAME_STEP
        begins = is_waiting | (self.finished & in_same_step)
        self.ended = self.finished & (not in_same_step)
        self.episode += begins
        self.chosen = torch.where(begins, starts.draw(seeds, self.episode), -1)  # The next start; -1 is none.


class DeviceTask:
    """The task of all worlds; its memory keeps its place on the device."""

    def __init__(self, infants: Sequence[InfantEnv], body: torch.Tensor):
        terms = [_term_of(infant) for infant in infants]
        first = infants[0]
        if field := differing_field(terms):
            raise DeviceError(f"the tasks of these infants differ in '{field}', which all worlds of a device share")
        self._term: Any = stack_terms([terms[index] for index in body.tolist()], put)
        states = [infant.task.state for infant in infants]
        self.memory = {name: put(np.stack([state[name] for state in states]))[body] for name in states[0]}
        self.observed = tuple(first.task.spaces)  # Names of what is remembered and observed.
        for name in self.observed:
            if name not in self.memory:
                raise DeviceError(f"the task observes '{name}' without remembering it; do, or leave out device")
        self._forced = put(first.task.forced)
        self._rows = {name: put(rows) for name, rows in rows_by_name(first.task.model_fields).items()}
        self._is_checked = False

    def judge(self, worlds: Worlds, model: mjw.Model, actions: torch.Tensor) -> Judgement:
        """Return the judgement of a control step, and apply its changes; actions have the shape (worlds, n)."""
        before = {name: values.clone() for name, values in self.memory.items()}
        judgement: Judgement = self._term(worlds, actions, before)
        if not self._is_checked:
            check_term_judgement(judgement, self._term, len(actions), before, {FORCES, *self._rows})
            self._is_checked = True
        for name, values in judgement.memory.items():
            self.memory[name].copy_(values)
        for name, change in judgement.changes.items():
            if name == FORCES:
                _change(worlds.xfrc_applied, self._forced, change)
            elif name in BATCHED:  # MuJoCo Warp does not read others.
                _change(wp.to_torch(getattr(model, name)), self._rows[name], change)
        return judgement


def _change(array: torch.Tensor, rows: torch.Tensor, change: Change) -> None:
    """Write new values to rows of a field of the model, shape (worlds, rows, ...), where they change."""
    places = (slice(None), rows) if change.column is None else (slice(None), rows, change.column)
    former = array[places]
    array[places] = where_worlds(change.where, change.values().reshape(former.shape), former)


@dataclass(frozen=True)
class _NoGoal(Term):
    def __call__(self, worlds: Worlds, *args: Any) -> Judgement:
        return NO_REWARD


def _term_of(infant: InfantEnv) -> Term:
    task = infant.task
    if type(task) is Task and task.term is None:
        return _NoGoal()
    if task.term is None:
        name = task.class_name if isinstance(task, CustomTask) else infant.manifest.task.kind
        raise DeviceError(
            f"task '{name}' is not a term, so it runs on the CPU only: write its judgement as one "
            "(docs/own_reward.md), or leave out device"
        )
    return task.term
