"""How episodes begin on a device: a table of starts of each infant, which single environments have drawn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp
from gymnasium.utils import seeding

from mimoc.model_fields import ModelField
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import flat, put
from mimoc.runtime.warp.tasks import DeviceTask
from mimoc.runtime.warp.touch import Feeling
from mimoc.runtime.warp.vision.sight import VISION, Sight
from mimoc.senses.sense import FloatArray, IntArray

STATE = ("qpos", "qvel", "act", "ctrl", "qacc_warmstart")
"""Fields of a state that an episode begins with; the first physics step computes all others."""


@dataclass(frozen=True, slots=True)
class Place:
    """Some numbers of each world that a start sets."""

    columns: wp.array
    """Which of the world's numbers, shape (k,)."""
    table: wp.array
    """Their values at each start, shape (starts, k)."""


@dataclass(frozen=True, slots=True)
class Starts:
    """All starts of all bodies in one pose, those of a body side by side."""

    first: wp.array
    """The first one of each body, shape (bodies,)."""
    count: wp.array
    """How many each has, shape (bodies,)."""
    state: Mapping[str, wp.array]
    """Fields of the state, shape (starts, k) each."""
    model: Mapping[str, Place]
    """Fields of the model that episodes change."""
    memory: wp.array
    """What the task remembers, shape (starts, m)."""
    commands: wp.array
    """The control of each commanded actuator at the start, shape (starts, n)."""
    samples: Mapping[str, wp.array]
    """What each sense tells at the start, shape (starts, n)."""

    def restore(self, start: wp.array, model: mjw.Model, data: mjw.Data, memory: wp.array | None) -> None:
        """Put worlds into their starts; -1 leaves a world as it is."""
        for name, table in self.state.items():
            _restore_all(start, table, getattr(data, name))
        for name, place in self.model.items():
            inputs = [start, place.columns, place.table]
            wp.launch(_restore, (start.shape[0], place.columns.shape[0]), inputs, [flat(getattr(model, name))])
        if memory is not None:
            _restore_all(start, self.memory, memory)


def model_fields(infant: InfantEnv) -> list[ModelField]:
    """Return what episodes change in the model of an infant."""
    constraints = Constraints(infant.manifest.constraints, infant.model)
    return [*constraints.model_fields, *infant.task.model_fields]


def drawn(
    infants: Sequence[InfantEnv], most: int, pose: str | None, model: mjw.Model, task: DeviceTask, touch: Feeling | None
) -> Starts:
    """Return the starts of all infants.

    Start k of an infant is that of a single environment with seed k; an infant without chance in its starts has one.

    Args:
        infants: The different bodies.
        most: How many starts each has, if there is chance in them.
        pose: The pose, or their own.
        model: The model of all worlds.
        task: The task.
        touch: How touch is told, if there is any.
    """
    rows: list[dict[str, FloatArray]] = []
    counts = []
    for infant in infants:
        found = _starts(infant, most, {} if pose is None else {"pose": pose}, task, touch)
        counts.append(len(found))
        rows += found
    tables = {name: put(np.stack([row[name] for row in rows])) for name in rows[0]}
    return Starts(
        put(np.cumsum([0, *counts[:-1]]), wp.int32),
        put(counts, wp.int32),
        {name: tables[name] for name in STATE},
        _places(infants[0], model, tables),
        tables["memory"],
        tables["commands"],
        {name: tables[f"sense {name}"] for name in _numbers(infants[0])},
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
    kept = [wp.clone(array) for array in changed]
    first, counts = starts.first.numpy()[body_of_world], starts.count.numpy()[body_of_world]
    same = body_of_world[:, None] == body_of_world
    turns, rank = same.sum(axis=1), np.tril(same, -1).sum(axis=1)
    seen: dict[int, IntArray] = {}
    for earlier in range(int(np.ceil(counts / turns).max())):
        own = rank + earlier * turns
        chosen = np.where(own < counts, first + own, -1)
        starts.restore(put(chosen, wp.int32), model, data, None)
        mjw.kinematics(model, data)
        mjw.camlight(model, data)
        pictures = sight.look(data).numpy().copy()  # On the CPU it is the same memory again.
        seen |= {start: picture for start, picture in zip(chosen.tolist(), pictures, strict=True) if start >= 0}
    for array, former in zip(changed, kept, strict=True):
        wp.copy(array, former)
    return put(np.stack([seen[start] for start in sorted(seen)]), wp.uint8)


def _starts(
    infant: InfantEnv, most: int, options: dict[str, Any], task: DeviceTask, touch: Feeling | None
) -> list[dict[str, FloatArray]]:
    found = []
    for seed in range(most):
        infant.reset(seed=seed, options=options)
        found.append(_start(infant, task, touch))
        if infant.np_random.bit_generator.state == seeding.np_random(seed)[0].bit_generator.state:
            break  # Nothing was drawn.
    return found


def _start(infant: InfantEnv, task: DeviceTask, touch: Feeling | None) -> dict[str, FloatArray]:
    """Return the numbers of the state that an infant is in, by what they are."""
    found: dict[str, FloatArray] = {name: getattr(infant.data, name).copy() for name in STATE}
    found["commands"] = infant.data.ctrl[infant.actuation.actuators]
    found["memory"] = np.array(task.memory(infant.task.state), float)
    for field in model_fields(infant):
        found.setdefault(f"model {field.name}", np.zeros(0))
        values = np.asarray(getattr(infant.model, field.name)[field.rows], float).ravel()
        found[f"model {field.name}"] = np.concatenate([found[f"model {field.name}"], values])
    for name in _numbers(infant):
        sample = infant.senses[name](infant.data).astype(float).ravel()  # Noise is drawn for each episode.
        found[f"sense {name}"] = touch.start(sample) if touch and name == "touch" else sample
    return found


def _numbers(infant: InfantEnv) -> list[str]:
    """Return the senses that are vectors of numbers."""
    return [name for name in infant.senses if name != VISION]


def _places(infant: InfantEnv, model: mjw.Model, tables: Mapping[str, wp.array]) -> dict[str, Place]:
    """Return where the fields of the model are that episodes change, without those that MuJoCo Warp does not read."""
    columns: dict[str, list[int]] = {}
    for field in model_fields(infant):
        own = getattr(model, field.name, None)
        if isinstance(own, wp.array) and own.shape[0] > 1 and len(field.rows):
            theirs = getattr(infant.model, field.name)
            numbers, stride = theirs[0].size, flat(own).shape[1] // len(theirs)
            found = field.rows[:, None] * stride + np.arange(numbers)
            columns.setdefault(field.name, []).extend(found.ravel().tolist())
    return {name: Place(put(found, wp.int32), tables[f"model {name}"]) for name, found in columns.items()}


def _restore_all(start: wp.array, table: wp.array, values: wp.array) -> None:
    if table.shape[1]:
        wp.launch(_restore_rows, (start.shape[0], table.shape[1]), [start, table], [values])


@wp.kernel(enable_backward=False)
def _restore_rows(start: wp.array[int], table: wp.array2d[float], values: wp.array2d[float]):
    world, number = wp.tid()
    if start[world] >= 0:
        values[world, number] = table[start[world], number]


@wp.kernel(enable_backward=False)
def _restore(start: wp.array[int], columns: wp.array[int], table: wp.array2d[float], values: wp.array2d[float]):
    world, number = wp.tid()
    if start[world] >= 0:
        values[world, columns[number]] = table[start[world], number]
