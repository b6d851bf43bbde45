"""The task of all infants on a device: its term, over torch's views of all worlds."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.model_fields import rows_by_name
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.term import Term, differing_field, stack_terms
from mimoc.runtime.warp.arrays import flat
from mimoc.runtime.warp.bodies import batched_fields
from mimoc.runtime.warp.device_worlds import put_on
from mimoc.runtime.warp.needs import DeviceError
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.senses.sense import IntArray
from mimoc.tasks.task import NO_REWARD, Change, CustomTask, Judgement, Task


class DeviceTask:
    """Judges all worlds at once; what the task remembers of each keeps its place in memory."""

    def __init__(self, infants: Sequence[InfantEnv], body_of_world: IntArray):
        """Stack the terms of all worlds on Warp's present device.

        Args:
            infants: The different bodies.
            body_of_world: Which of them lives in each world, shape (worlds,).

        Raises:
            DeviceError: If the task is not a term, not one that all infants can share, or observes what it does not
                remember.
        """
        terms, first, put = [_term_of(infant) for infant in infants], infants[0], put_on(wp.get_device())
        if field := differing_field(terms):
            raise DeviceError(f"the tasks of these infants differ in '{field}', which all worlds of a device share")
        self._term: Any = stack_terms([terms[body] for body in body_of_world], put)
        states = [infant.task.state for infant in infants]
        self.memory = {name: put(np.stack([state[name] for state in states])[body_of_world]) for name in states[0]}
        """What the task remembers of each world, shape (worlds, ...)."""
        self.terms = _reward_terms(terms[0], first)
        """Names of the terms of the reward."""
        self.observed = tuple(first.task.spaces)
        """Names of what is remembered and observed."""
        for name in self.observed:
            if name not in self.memory:
                raise DeviceError(f"the task observes '{name}' without remembering it; do, or leave out device")
        self._rows = {name: put(rows) for name, rows in rows_by_name(first.task.model_fields).items()}
        self._writable = frozenset(batched_fields())

    def judge(self, worlds: Worlds, model: mjw.Model, actions: torch.Tensor) -> Judgement:
        """Return the judgement of a control step of all worlds, with actions of shape (worlds, n)."""
        before = {name: values.clone() for name, values in self.memory.items()}
        judgement: Judgement = self._term(worlds, actions, before)
        for name, values in judgement.memory.items():
            self.memory[name].copy_(values)
        for name, change in judgement.changes.items():
            if name in self._writable:  # MuJoCo Warp does not read others.
                self._change(getattr(model, name), self._rows[name], change)
        return judgement

    def _change(self, field: wp.array, rows: torch.Tensor, change: Change) -> None:
        """Write new values to rows of a field of the model, shape (worlds, rows, ...), where they change."""
        numbers = wp.to_torch(flat(field))
        stride = numbers.shape[1] // field.shape[1]
        columns = torch.arange(stride, device=rows.device) if change.column is None else change.column
        places = (stride * rows[:, None] + columns).flatten()
        values = change.values().reshape(len(numbers), -1)
        numbers[:, places] = torch.where(change.where[:, None], values, numbers[:, places])


@dataclass(frozen=True)
class _NoGoal(Term):
    """What judges worlds without a goal."""

    def __call__(self, worlds: Worlds, *args: Any) -> Judgement:
        return NO_REWARD


def _term_of(infant: InfantEnv) -> Term:
    """Return what judges an infant.

    Raises:
        DeviceError: If no term does.
    """
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


def _reward_terms(term: Term, infant: InfantEnv) -> tuple[str, ...]:
    """Return the names of the terms of an infant's reward, which it is judged for."""
    memory = {name: np.asarray(values)[None] for name, values in infant.task.state.items()}
    action = np.zeros((1, len(infant.actuation.low)))
    one: Any = stack_terms([term])
    return tuple(one(worlds_of_one(infant.data), action, memory).reward_terms)
