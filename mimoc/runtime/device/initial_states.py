"""How episodes begin on a device: a table of starts of each infant, which single environments have drawn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.utils import seeding

from mimoc.base.model_fields import rows_by_name
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.device.arrays import flat, put_on, to_device, where_worlds
from mimoc.runtime.device.bodies import batched_fields
from mimoc.runtime.device.touch import TouchReader
from mimoc.runtime.device.vision.reader import VISION, VisionReader
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.term import Put
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.tasks.task import NOTHING

STATE = ("qpos", "qvel", "act", "ctrl", "qacc_warmstart")
"""Fields of a state that an episode begins with; the first physics step computes all others."""


class Table(NamedTuple):
    """Some numbers of a world at each start."""

    values: torch.Tensor
    """Shape (starts, ...)."""
    columns: Any = ...
    """Which of a world's numbers these are; by default, all."""

    def write(self, start: torch.Tensor, numbers: torch.Tensor) -> None:
        """Write to the numbers of the worlds that begin with a start, shape (worlds,); -1 is none."""
        new = self.values[start.clamp(min=0)]
        numbers[:, self.columns] = where_worlds(start >= 0, new, numbers[:, self.columns])


@dataclass(frozen=True, slots=True)
class InitialStates:
    """All starts of all bodies in one pose, those of a body side by side."""

    first: wp.array
    """The first one of each body, shape (bodies,)."""
    count: wp.array
    """How many each has, shape (bodies,)."""
    fields: Mapping[str, Table]
    """Fields of the state, and of the model where episodes change them."""
    memory: Mapping[str, Table]
    """What the task remembers."""
    commands: wp.array
    """The control of each commanded actuator at the start, shape (starts, n)."""
    samples: Mapping[str, wp.array]
    """What each sense measures at the start, shape (starts, n)."""

    def restore(
        self, chosen: wp.array, model: mjw.Model, data: mjw.Data, memory: Mapping[str, torch.Tensor] = NOTHING
    ) -> None:
        """Put worlds into their starts; -1 leaves a world as it is."""
        start = wp.to_torch(chosen).long()
        for name, table in self.fields.items():
            table.write(start, flat(_field(name, model, data)))
        for name, values in memory.items():
            self.memory[name].write(start, values)


def changed_rows(infant: InfantEnv) -> dict[str, IntArray]:
    """Return which rows of fields of its model an infant's episodes change."""
    constraints = Constraints(infant.manifest.constraints, infant.model)
    return rows_by_name([*constraints.model_fields, *infant.task.model_fields])


def sample_initial_states(
    infants: Sequence[InfantEnv], most: int, pose: str | None, model: mjw.Model, touch: TouchReader | None
) -> InitialStates:
    """Return the starts of all infants.

    Start k of an infant is that of a single environment with seed k; an infant without chance in its starts has one.

    Args:
        infants: The different bodies.
        most: How many starts each has, if there is chance in them.
        pose: The pose, or their own.
        model: The model of all worlds.
        touch: What measures touch, if anything does.
    """
    options, first = {} if pose is None else {"pose": pose}, infants[0]
    starts = [_starts(infant, most, options, touch) for infant in infants]
    rows, counts = [row for of_infant in starts for row in of_infant], [len(of_infant) for of_infant in starts]
    tables, put_torch = {name: np.stack([row[name] for row in rows]) for name in rows[0]}, put_on(wp.get_device())
    columns = {name: ... for name in STATE if tables[name].size} | _columns(first, model, put_torch)
    return InitialStates(
        to_device(np.cumsum([0, *counts[:-1]]), wp.int32),
        to_device(counts, wp.int32),
        {name: Table(put_torch(tables[name]), which) for name, which in columns.items()},
        {name: Table(put_torch(tables[f"memory {name}"])) for name in first.task.state},
        to_device(tables["commands"]),
        {name: to_device(tables[f"sense {name}"]) for name in first.senses if name != VISION},
    )


def seen_at(
    starts: InitialStates, sight: VisionReader, body_of_world: IntArray, model: mjw.Model, data: mjw.Data
) -> wp.array:
    """Return what is seen at each start, shape (starts, n), in 8 bits.

    The worlds are lent for it, each for the starts of its own body, and are left as they were.

    Args:
        starts: The starts.
        sight: The eyes.
        body_of_world: Which body lives in each world.
        model: The model of all worlds.
        data: Their states.
    """
    changed = [_field(name, model, data) for name in starts.fields]
    former = [wp.clone(array) for array in changed]
    first, counts = starts.first.numpy()[body_of_world], starts.count.numpy()[body_of_world]
    same = body_of_world[:, None] == body_of_world
    worlds_of_body, rank = same.sum(axis=1), np.tril(same, -1).sum(axis=1)
    seen: dict[int, IntArray] = {}
    for earlier in range(int(np.ceil(counts / worlds_of_body).max())):
        index = rank + earlier * worlds_of_body
        chosen = np.where(index < counts, first + index, -1)
        starts.restore(to_device(chosen, wp.int32), model, data)
        mjw.kinematics(model, data)
        mjw.camlight(model, data)
        pictures = sight(data).cpu().numpy()
        seen |= {start: picture for start, picture in zip(chosen.tolist(), pictures, strict=True) if start >= 0}
    for array, values in zip(changed, former, strict=True):
        wp.copy(array, values)
    return to_device(np.stack([seen[start] for start in sorted(seen)]), wp.uint8)


def _starts(
    infant: InfantEnv, most: int, options: dict[str, Any], touch: TouchReader | None
) -> list[dict[str, FloatArray]]:
    starts = []
    for seed in range(most):
        infant.reset(seed=seed, options=options)
        starts.append(_start(infant, touch))
        if infant.np_random.bit_generator.state == seeding.np_random(seed)[0].bit_generator.state:
            break  # Nothing was drawn.
    return starts


def _start(infant: InfantEnv, touch: TouchReader | None) -> dict[str, FloatArray]:
    """Return the numbers of the state that an infant is in, by what they are."""
    numbers: dict[str, FloatArray] = {name: getattr(infant.data, name).copy() for name in STATE}
    numbers["commands"] = infant.data.ctrl[infant.actuation.actuators]
    numbers |= {f"memory {name}": values for name, values in infant.task.state.items()}
    for name, rows in changed_rows(infant).items():
        numbers[name] = np.asarray(getattr(infant.model, name)[rows], float).ravel()
    for name in infant.senses.keys() - {VISION}:
        sample = infant.senses[name](infant.data).astype(float).ravel()  # Noise is drawn for each episode.
        numbers[f"sense {name}"] = touch.start(sample) if touch and name == "touch" else sample
    return numbers


def _columns(infant: InfantEnv, model: mjw.Model, put_torch: Put) -> dict[str, Any]:
    """Return where the numbers of these rows are in each world, without fields that MuJoCo Warp does not read."""
    columns: dict[str, Any] = {}
    for name, rows in changed_rows(infant).items():
        single = getattr(infant.model, name)
        if name in batched_fields() and len(rows):
            stride = flat(getattr(model, name)).shape[1] // len(single)
            columns[name] = put_torch((rows[:, None] * stride + np.arange(single[0].size)).ravel())
    return columns


def _field(name: str, model: mjw.Model, data: mjw.Data) -> wp.array:
    return getattr(data if name in STATE else model, name)
