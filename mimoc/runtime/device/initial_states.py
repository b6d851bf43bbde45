"""How episodes begin on a device: a table of starts of each infant, which single environments have drawn."""

import json
from collections.abc import Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.utils import seeding

from mimoc.runtime.arousal import Arousal
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.device.arrays import put, where_worlds
from mimoc.runtime.device.bodies import BATCHED
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.judgement import FORCES, NOTHING
from mimoc.runtime.model_fields import rows_by_name
from mimoc.runtime.objects import Objects
from mimoc.runtime.sense import IntArray

VISION = "vision"
STATE = ("qpos", "qvel", "act", "ctrl", "qacc_warmstart", FORCES)
"""Fields of a state that an episode begins with; the first physics step computes all others."""
Start = tuple[dict[str, Any], dict[str, Any], dict[str, Any]]
"""Fields, what the task remembers, and samples at a start."""
StartOptions = str  # Options of a reset that decide on starts, `pose` and `objects`, as JSON with sorted keys.
AS_BUILT: StartOptions = "{}"
BITS_32 = 2**32 - 1


class Table(NamedTuple):
    """Some numbers of a world at each start."""

    values: torch.Tensor  # Shape (starts, rows, ...).
    rows: Any = ...  # Which rows of a world's numbers these are; by default, all.

    def write(self, start: torch.Tensor, array: torch.Tensor) -> None:
        """Write to the numbers of the worlds that begin with a start, shape (worlds,); -1 is none."""
        array[:, self.rows] = where_worlds(start >= 0, self.values[start.clamp(min=0)], array[:, self.rows])


@dataclass(frozen=True, slots=True)
class InitialStates:
    """All starts of all bodies with the same options, those of a body side by side."""

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
        """Return a start for each world by chance, which depends on its seed and the number of its episode alone."""
        return self.first + _hash(_hash(seeds.long()) + episodes) % self.count


def _hash(numbers: torch.Tensor) -> torch.Tensor:
    """Return 32 bits that look random for each whole number: the hash RXS-M-XS of PCG (O'Neill 2014)."""
    state = (numbers * 747796405 + 2891336453) & BITS_32
    word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) & BITS_32
    return (word >> 22) ^ word


def changed_rows(infant: InfantEnv) -> dict[str, IntArray]:
    """Return which rows of fields of its model an infant's episodes change, if MuJoCo Warp reads these fields."""
    constraints, objects = (
        Constraints(infant.manifest.constraints, infant.model),
        Objects(infant.manifest, infant.model),
    )
    rows = rows_by_name([*constraints.model_fields, *infant.task.model_fields, *objects.model_fields])
    return {name: rows[name] for name in rows.keys() & BATCHED if len(rows[name])}


def changed_fields(infants: Sequence[InfantEnv]) -> set[str]:
    """Return which fields of their models episodes of some infants change, arousal included."""
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

    Start k of an infant is that of a single environment with seed k; an infant without chance in its starts has one.
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
    first, count = put(np.cumsum([0, *counts[:-1]]))[body], put(counts)[body]
    initial = InitialStates(first, count, tables, {name: Table(values) for name, values in memory.items()}, samples)
    if VISION in readers:
        samples[VISION] = _seen_at(initial, readers[VISION], body, model, data)
    return initial


def _starts(
    infant: InfantEnv, most: int, options: StartOptions, rows: Mapping[str, IntArray], readers: Mapping[str, Any]
) -> list[Start]:
    """Return fields, what the task remembers, and samples at each start of an infant; of noise, each episode draws."""
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
