"""Tasks on a device: rewards, and how episodes end."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.base.model_fields import rows_by_name
from mimoc.runtime.device.arrays import flat, put_on, to_device
from mimoc.runtime.device.bodies import batched_fields
from mimoc.runtime.device.capacity import LENGTH, is_losing, report
from mimoc.runtime.device.initial_states import InitialStates
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.term import Term, differing_field, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.senses.sense import IntArray
from mimoc.tasks.task import NO_REWARD, Change, CustomTask, Judgement, Task

TOO_MUCH = 1e10
"""Position, velocity or acceleration beyond which a simulation is unstable (MuJoCo's mjMAXVAL)."""
NEVER = 2**31 - 1
BITS_32 = 2**32 - 1


class EpisodeEnds:
    """What comes of each control step; arrays have the shape (worlds,) if nothing else is said."""

    def __init__(
        self, infants: Sequence[InfantEnv], body: wp.array, terms: Sequence[str], max_steps: int | None, seeds: wp.array
    ):
        """Make arrays.

        Args:
            infants: The different bodies, which determine how long episodes are.
            body: Which body lives in each world.
            terms: Names of the terms of the reward.
            max_steps: Control steps after which any episode is truncated.
            seeds: Of each world, shape (worlds,).
        """
        worlds, self._body, self._names = body.shape[0], wp.to_torch(body).long(), terms
        limits = [min(NEVER if limit is None else limit for limit in (env.max_steps, max_steps)) for env in infants]
        self._limits = wp.to_torch(to_device(limits, wp.int32))[self._body]
        self.terms = wp.zeros((worlds, len(terms)), dtype=float)
        self.reward = wp.zeros(worlds, dtype=float)
        self.success, self.terminated, self.truncated, self.unstable, self.ended, self.steps, self.episode = (
            wp.zeros(worlds, dtype=int) for _ in range(7)
        )
        self.overflowed = wp.zeros(worlds, dtype=int)
        """Whether contacts or constraints of the infant did not fit, and were lost."""
        self.chosen = wp.full(worlds, -1, dtype=int)
        """The start of the next episode of worlds that begin one now, -1 for others."""
        self.finished = wp.zeros(worlds, dtype=int)
        """Whether an episode has ended in this very step."""
        self.seeds = seeds
        self.report = wp.zeros(LENGTH, dtype=int)
        """What the CPU must know of the last step; see `capacity.report`."""

    def forget(self, worlds: Iterable[int]) -> None:
        """Choose the same starts again, after the first, in worlds that have a new seed."""
        wp.to_torch(self.episode)[list(worlds)] = 0

    def judge(
        self, judgement: Judgement, data: mjw.Data, actions: wp.array, mode: AutoresetMode, first: InitialStates
    ) -> None:
        """Add up rewards, find what ends, and choose where to begin again.

        Args:
            judgement: What the task says of the control step.
            data: The states of all worlds.
            actions: Of the control step, shape (worlds, n).
            mode: When worlds whose episode has ended begin another.
            first: The starts they begin with.
        """
        is_waiting = wp.to_torch(self.ended).bool() & (mode == AutoresetMode.NEXT_STEP)
        is_broken = ~_is_bounded(data)
        unstable = is_broken & ~is_waiting
        overflowed = is_losing(data) & ~is_broken & ~is_waiting
        is_judged = ~unstable & ~is_waiting
        terminated = (is_judged & judgement.terminated) | unstable
        steps = wp.to_torch(self.steps) + 1
        truncated = ((steps >= self._limits) | overflowed) & ~is_waiting
        finished, in_same_step = truncated | terminated, mode == AutoresetMode.SAME_STEP
        self._write(is_judged, judgement)
        self._set(success=is_judged & judgement.success, terminated=terminated, truncated=truncated, steps=steps)
        self._set(unstable=unstable, overflowed=overflowed, finished=finished)
        self._set(ended=finished & (not in_same_step), report=report(data, actions, unstable, overflowed))
        begins = is_waiting | (finished & in_same_step)
        wp.to_torch(self.episode).add_(begins)
        self._set(chosen=torch.where(begins, self._start_of(first), -1))

    def begin(self, chosen: wp.array) -> None:
        """Count from the start again in worlds that begin an episode."""
        wp.to_torch(self.steps).masked_fill_(wp.to_torch(chosen) >= 0, 0)

    def _start_of(self, starts: InitialStates) -> torch.Tensor:
        """Return a start for each world by chance, which depends on its seed and the number of its episode alone."""
        first, count = wp.to_torch(starts.first)[self._body], wp.to_torch(starts.count)[self._body]
        return first + _hash(_hash(wp.to_torch(self.seeds).long()) + wp.to_torch(self.episode)) % count

    def _write(self, is_judged: torch.Tensor, judgement: Judgement) -> None:
        """Write the terms of the reward and their sum, which are zero in worlds that are not judged."""
        terms = wp.to_torch(self.terms)
        for column, name in enumerate(self._names):
            terms[:, column] = torch.where(is_judged, judgement.reward_terms[name], 0.0)
        self._set(reward=terms.sum(dim=1))

    def _set(self, **values: Any) -> None:
        """Write to arrays, which keep their places in memory, by name."""
        for name, value in values.items():
            wp.to_torch(getattr(self, name)).copy_(value)


def _is_bounded(data: mjw.Data) -> torch.Tensor:
    """Return whether all numbers of the state of each world are there and not too large, shape (worlds,)."""
    fields = [wp.to_torch(field).abs() <= TOO_MUCH for field in (data.qpos, data.qvel, data.qacc)]
    return torch.cat(fields, dim=1).all(dim=1)


def _hash(numbers: torch.Tensor) -> torch.Tensor:
    """Return 32 bits that look random for each whole number: the hash RXS-M-XS of PCG (O'Neill 2014)."""
    state = (numbers * 747796405 + 2891336453) & BITS_32
    word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) & BITS_32
    return (word >> 22) ^ word


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
        numbers = flat(field)
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
