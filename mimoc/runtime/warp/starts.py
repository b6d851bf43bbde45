"""How episodes begin on a device: a table of starts of each infant, which single environments have drawn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.utils import seeding

from mimoc.model_fields import ModelField
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import flat, put
from mimoc.runtime.warp.bodies import batched_fields
from mimoc.runtime.warp.device_worlds import put_on
from mimoc.runtime.warp.touch import Feeling
from mimoc.runtime.warp.vision.sight import VISION, Sight
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.tasks.task import NOTHING

STATE = ("qpos", "qvel", "act", "ctrl", "qacc_warmstart")
"""Fields of a state that an episode begins with; the first physics step computes all others."""


@dataclass(frozen=True, slots=True)
class ModelNumbers:
    """Some numbers of a field of the model that a start sets."""

    columns: torch.Tensor
    """Which of a world's numbers, shape (n,)."""
    table: torch.Tensor
    """Their values at each start, shape (starts, n)."""


@dataclass(frozen=True, slots=True)
class Starts:
    """All starts of all bodies in one pose, those of a body side by side."""

    first: wp.array
    """The first one of each body, shape (bodies,)."""
    count: wp.array
    """How many each has, shape (bodies,)."""
    state: Mapping[str, torch.Tensor]
    """Fields of the state, shape (starts, n) each."""
    model: Mapping[str, ModelNumbers]
    """Fields of the model that episodes change."""
    memory: Mapping[str, torch.Tensor]
    """What the task remembers, shape (starts, ...) each."""
    commands: wp.array
    """The control of each commanded actuator at the start, shape (starts, n)."""
    samples: Mapping[str, wp.array]
    """What each sense measures at the start, shape (starts, n)."""

    def restore(
        self, chosen: wp.array, model: mjw.Model, data: mjw.Data, memory: Mapping[str, torch.Tensor] = NOTHING
    ) -> None:
        """Put worlds into their starts; -1 leaves a world as it is."""
        start = wp.to_torch(chosen).long()
        for name, table in self.state.items():
            if table.shape[1]:
                _restore(start, table, wp.to_torch(getattr(data, name)))
        for name, numbers in self.model.items():
            _restore(start, numbers.table, wp.to_torch(flat(getattr(model, name))), numbers.columns)
        for name, values in memory.items():
            _restore(start, self.memory[name], values)


def model_fields(infant: InfantEnv) -> list[ModelField]:
    """Return what episodes change in the model of an infant."""
    constraints = Constraints(infant.manifest.constraints, infant.model)
    return [*constraints.model_fields, *infant.task.model_fields]


def drawn(infants: Sequence[InfantEnv], most: int, pose: str | None, model: mjw.Model, touch: Feeling | None) -> Starts:
    """Return the starts of all infants.

    Start k of an infant is that of a single environment with seed k; an infant without chance in its starts has one.

    Args:
        infants: The different bodies.
        most: How many starts each has, if there is chance in them.
        pose: The pose, or their own.
        model: The model of all worlds.
        touch: How touch is told, if there is any.
    """
    rows: list[dict[str, FloatArray]] = []
    counts = []
    for infant in infants:
        found = _starts(infant, most, {} if pose is None else {"pose": pose}, touch)
        counts.append(len(found))
        rows += found
    tables = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    put_torch = put_on(wp.get_device())
    return Starts(
        put(np.cumsum([0, *counts[:-1]]), wp.int32),
        put(counts, wp.int32),
        {name: put_torch(tables[name]) for name in STATE},
        {
            name: ModelNumbers(put_torch(at), put_torch(tables[name]))
            for name, at in _columns(infants[0], model).items()
        },
        {name: put_torch(tables[f"memory {name}"]) for name in infants[0].task.state},
        put(tables["commands"]),
        {name: put(tables[f"sense {name}"]) for name in _numbers(infants[0])},
    )


def seen_at(starts: Starts, sight: Sight, body_of_world: IntArray, model: mjw.Model, data: mjw.Data) -> wp.array:
    """Return what is seen at each start, shape (starts, n), in 8 bits.

    The worlds are lent for it, each for the starts of its own body, and are left as they were.

    Args:
        starts: The starts.
        sight: The eyes.
        body_of_world: Which body lives in each world.
        model: The model of all worlds.
        data: Their states.
    """
    changed = [getattr(data, name) for name in starts.state] + [getattr(model, name) for name in starts.model]
    former = [wp.clone(array) for array in changed]
    first, counts = starts.first.numpy()[body_of_world], starts.count.numpy()[body_of_world]
    same = body_of_world[:, None] == body_of_world
    worlds_of_body, rank = same.sum(axis=1), np.tril(same, -1).sum(axis=1)
    seen: dict[int, IntArray] = {}
    for earlier in range(int(np.ceil(counts / worlds_of_body).max())):
        index = rank + earlier * worlds_of_body
        chosen = np.where(index < counts, first + index, -1)
        starts.restore(put(chosen, wp.int32), model, data)
        mjw.kinematics(model, data)
        mjw.camlight(model, data)
        pictures = sight.look(data).numpy().copy()  # On the CPU it is the same memory again.
        seen |= {start: picture for start, picture in zip(chosen.tolist(), pictures, strict=True) if start >= 0}
    for array, values in zip(changed, former, strict=True):
        wp.copy(array, values)
    return put(np.stack([seen[start] for start in sorted(seen)]), wp.uint8)


def _starts(
    infant: InfantEnv, most: int, options: dict[str, Any], touch: Feeling | None
) -> list[dict[str, FloatArray]]:
    found = []
    for seed in range(most):
        infant.reset(seed=seed, options=options)
        found.append(_start(infant, touch))
        if infant.np_random.bit_generator.state == seeding.np_random(seed)[0].bit_generator.state:
            break  # Nothing was drawn.
    return found


def _start(infant: InfantEnv, touch: Feeling | None) -> dict[str, FloatArray]:
    """Return the numbers of the state that an infant is in, by what they are."""
    found: dict[str, FloatArray] = {name: getattr(infant.data, name).copy() for name in STATE}
    found["commands"] = infant.data.ctrl[infant.actuation.actuators]
    found |= {f"memory {name}": values for name, values in infant.task.state.items()}
    for name, rows in _changed_rows(infant).items():
        found[name] = np.asarray(getattr(infant.model, name)[rows], float).ravel()
    for name in _numbers(infant):
        sample = np.array(infant.senses[name](infant.data), float)  # Without noise, which is drawn for each episode.
        found[f"sense {name}"] = touch.start(sample) if touch and name == "touch" else sample
    return found


def _numbers(infant: InfantEnv) -> list[str]:
    """Return the senses that are vectors of numbers."""
    return [name for name in infant.senses if name != VISION]


def _changed_rows(infant: InfantEnv) -> dict[str, IntArray]:
    """Return the rows of fields of the model that episodes change."""
    fields = model_fields(infant)
    return {field.name: np.concatenate([each.rows for each in fields if each.name == field.name]) for field in fields}


def _columns(infant: InfantEnv, model: mjw.Model) -> dict[str, IntArray]:
    """Return where the numbers of these rows are in each world, without fields that MuJoCo Warp does not read."""
    columns: dict[str, IntArray] = {}
    for name, rows in _changed_rows(infant).items():
        single = getattr(infant.model, name)
        if name in batched_fields() and len(rows):
            stride = flat(getattr(model, name)).shape[1] // len(single)
            columns[name] = (rows[:, None] * stride + np.arange(single[0].size)).ravel()
    return columns


def _restore(start: torch.Tensor, table: torch.Tensor, values: torch.Tensor, columns: Any = ...) -> None:
    """Write rows of a table to columns of values in the worlds that begin with them."""
    begins = (start >= 0).reshape(-1, *[1] * (table.ndim - 1))
    values[:, columns] = torch.where(begins, table[start.clamp(min=0)], values[:, columns])
