"""Tasks on a device: rewards, and how episodes end."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.runtime.device.arrays import put, where_worlds
from mimoc.runtime.device.bodies import BATCHED
from mimoc.runtime.device.capacity import is_losing, report
from mimoc.runtime.device.initial_states import InitialStates
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.judgement import FORCES, NO_REWARD, Change, Judgement, check_term_judgement
from mimoc.runtime.model_fields import rows_by_name
from mimoc.runtime.task import CustomTask, Task
from mimoc.runtime.term import Term, differing_field, stack_terms
from mimoc.runtime.worlds import Worlds

TOO_MUCH = 1e10  # Position, velocity or acceleration beyond which a simulation is unstable (MuJoCo's mjMAXVAL).
NEVER = 2**31 - 1


class EpisodeEnds:
    """What comes of each control step; arrays have the shape (worlds,)."""

    def __init__(self, infants: Sequence[InfantEnv], body: torch.Tensor, max_steps: int | None, mode: AutoresetMode):
        self._max_steps, self._mode = max_steps, mode
        self.limit(infants, body)
        self.steps, self.episode = torch.zeros_like(body), torch.zeros_like(body)
        self.ended = torch.zeros_like(body, dtype=torch.bool)
        """Whether the episode has ended and another one has not begun."""
        self.report: torch.Tensor | None = None
        """What the CPU must know of the last step; see `capacity.report`."""

    def limit(self, infants: Sequence[InfantEnv], body: torch.Tensor) -> None:
        """Let episodes be as long as those of the body that lives in each world, shape (worlds,)."""
        pairs = [(infant.max_steps, self._max_steps) for infant in infants]
        self.limits = put([min(NEVER if limit is None else limit for limit in pair) for pair in pairs])[body]
        """Control steps after which each episode is truncated."""

    def judge(
        self, judgement: Judgement, worlds: Worlds, actions: torch.Tensor, starts: InitialStates, seeds: torch.Tensor
    ) -> None:
        """Add up rewards, find what ends, and choose where to begin again; actions have the shape (worlds, n)."""
        is_waiting = self.ended & (self._mode == AutoresetMode.NEXT_STEP)
        is_broken = ~(torch.cat([worlds.qpos, worlds.qvel, worlds.qacc], dim=1).abs() <= TOO_MUCH).all(dim=1)
        is_judged = ~is_broken & ~is_waiting
        self.terms = {name: torch.where(is_judged, term, 0.0) for name, term in judgement.reward_terms.items()}
        self.reward = sum(self.terms.values(), torch.zeros_like(worlds.qpos[:, 0]))
        self.success = is_judged & judgement.success
        self.unstable = is_broken & ~is_waiting
        self.overflowed = is_losing(worlds) & is_judged
        """Whether contacts or constraints of the infant did not fit, and were lost."""
        self.terminated = (is_judged & judgement.terminated) | self.unstable
        self.steps += 1
        self.truncated = ((self.steps >= self.limits) | self.overflowed) & ~is_waiting
        self.finished = self.truncated | self.terminated
        """Whether an episode has ended in this very step."""
        self.report = report(worlds, actions, self.reward, self.unstable, self.overflowed)
        in_same_step = self._mode == AutoresetMode.SAME_STEP
        begins = is_waiting | (self.finished & in_same_step)
        self.ended = self.finished & (not in_same_step)
        self.episode += begins
        self.chosen = torch.where(begins, starts.draw(seeds, self.episode), -1)
        """The start of the next episode of worlds that begin one now, -1 for others."""


class DeviceTask:
    """Judges all worlds at once; what the task remembers of each keeps its place in memory."""

    def __init__(self, infants: Sequence[InfantEnv], body: torch.Tensor):
        """Stack the terms of the different bodies, by the body that lives in each world, shape (worlds,)."""
        terms, first = [_term_of(infant) for infant in infants], infants[0]
        if field := differing_field(terms):
            raise DeviceError(f"the tasks of these infants differ in '{field}', which all worlds of a device share")
        self._term: Any = stack_terms([terms[index] for index in body.tolist()], put)
        states = [infant.task.state for infant in infants]
        self.memory = {name: put(np.stack([state[name] for state in states]))[body] for name in states[0]}
        """What the task remembers of each world, shape (worlds, ...)."""
        self.observed = tuple(first.task.spaces)
        """Names of what is remembered and observed."""
        for name in self.observed:
            if name not in self.memory:
                raise DeviceError(f"the task observes '{name}' without remembering it; do, or leave out device")
        self._forced = put(first.task.forced)
        self._rows = {name: put(rows) for name, rows in rows_by_name(first.task.model_fields).items()}
        self._is_checked = False

    def judge(self, worlds: Worlds, model: mjw.Model, actions: torch.Tensor) -> Judgement:
        """Return the judgement of a control step of all worlds, with actions of shape (worlds, n)."""
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
    """What judges worlds without a goal."""

    def __call__(self, worlds: Worlds, *args: Any) -> Judgement:
        return NO_REWARD


def _term_of(infant: InfantEnv) -> Term:
    """Return what judges an infant."""
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
