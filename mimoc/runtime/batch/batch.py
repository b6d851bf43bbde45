"""Simulations side by side in threads, whose senses are read as arrays of all their infants."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.runtime.batch.physics import ThreadedPhysics
from mimoc.runtime.batch.senses import BatchSense, Read
from mimoc.runtime.control_step import ControlStep, MergedSegment
from mimoc.runtime.delays.schedule import Segment, arrived
from mimoc.runtime.delays.signals import DelayedSamples
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.runtime.simulation import Simulation
from mimoc.runtime.worlds import worlds_of_many

LEAST = 16
"""Number of worlds from which on they are cut into two groups: one is sampled while the other makes physics steps."""


@dataclass(frozen=True, slots=True)
class Sampling:
    """A sense that is sampled of some infants at once."""

    name: str
    infants: tuple[int, ...]
    read: Read
    delayed: Sequence[tuple[DelayedSamples, ...]]
    """The delays that the sample of each infant goes into."""
    is_noisy: bool


@dataclass(frozen=True, slots=True)
class Plan:
    """How a part of a control step is worked through."""

    groups: Sequence[Sequence[int]]
    samplings: Sequence[Sequence[Sampling]]
    """Senses that are sampled of the infants of each group at its end."""


class Batch:
    """Simulations of infants that sense and command the same; rows are infants, in order of worlds and within them.

    Row i is, bit for bit, what its infant is in its simulation alone.
    """

    def __init__(self, simulations: Sequence[Simulation], threads: int | None = None):
        self.simulations = tuple(simulations)
        self.infants = tuple(infant for world in self.simulations for infant in world.infants.values())
        self.world_of = [number for number, world in enumerate(self.simulations) for _ in world.infants]
        """The world of each row."""
        rows = iter(range(len(self.infants)))
        self.rows_of = [{name: next(rows) for name in world.infants} for world in self.simulations]
        """The rows of each world, by the names of its infants."""
        models, datas = [world.model for world in self.simulations], [world.data for world in self.simulations]
        self.physics = ThreadedPhysics(models, datas, threads)
        self._bind()

    def step(self, actions: npt.NDArray[Any], rows: Sequence[int]) -> None:
        """Make a control step of some infants, all of their worlds; actions are of all n, shape (n, commands)."""
        controls = self._controls(actions, rows)
        self._control_step({row: controls[row] for row in rows})

    def are_unstable(self) -> list[bool]:
        """Return whether the simulation of each infant has become unstable since its reset; see `is_unstable`."""
        worlds = self.physics.are_unstable()
        return [worlds[world] for world in self.world_of]

    def observe(self) -> Observation:
        """Return what all infants observe, as new arrays with a leading axis of n."""
        observation: Observation = {}
        for name, sense in self._senses.items():
            observation.update(sense.observe([arrived(delayed) for delayed in self._delayed[name]]))
        if self.infants[0].task.spaces:
            views = [infant.task.observe() for infant in self.infants]
            observation |= {name: np.stack([view[name] for view in views]) for name in views[0]}
        return observation

    def refresh(self) -> None:
        """Take over the models that simulations have got, in another scene or by growing."""
        pairs = enumerate(zip(self.simulations, self.physics.models, self.physics.datas, strict=True))
        changed = [
            number for number, (world, model, data) in pairs if world.data is not data or world.model is not model
        ]
        for number in changed:
            self.physics.replace(number, self.simulations[number].model, self.simulations[number].data)
        if changed:
            self._bind()

    def _bind(self) -> None:
        """Join what all infants have now; those of one bundle are worked through one after another."""
        firsts = {id(world.bundle): number for number, world in reversed(list(enumerate(self.simulations)))}
        self.order = sorted(
            range(len(self.simulations)), key=lambda number: firsts[id(self.simulations[number].bundle)]
        )
        """The order in which worlds are worked through."""
        models = [self.physics.models[world] for world in self.world_of]
        self._senses = {
            name: BatchSense(name, [infant.senses[name] for infant in self.infants], models, self.physics)
            for name in self.infants[0].senses
        }
        schedules = [infant.schedule for infant in self.infants]
        self._delayed = {name: [schedule.samples[name] for schedule in schedules] for name in self._senses}
        self._is_plain = all(infant.actuation.command is None for infant in self.infants)
        self._control_step = BatchStep(self.infants, self.world_of, self.physics, self._senses)

    def _controls(self, actions: npt.NDArray[Any], rows: Sequence[int]) -> FloatArray:
        """Return the controls of all infants, shape (n, commands), of which those of some rows are needed."""
        controls = actions.astype(np.float64)
        if not self._is_plain:
            for row in rows:
                infant = self.infants[row]
                controls[row] = infant.schedule.controls(actions[row], infant.data)
        return controls


class BatchStep(ControlStep[int]):
    """Goes through control steps of rows of a batch."""

    def __init__(
        self,
        infants: Sequence[Infant],
        world_of: Sequence[int],
        physics: ThreadedPhysics,
        senses: Mapping[str, BatchSense],
    ):
        datas = dict(enumerate(physics.datas[world] for world in world_of))
        super().__init__(dict(enumerate(infant.schedule for infant in infants)), datas)
        self._accompanied = {row for row, schedule in self._schedules.items() if schedule.companions}
        self._world_of, self._physics, self._senses = world_of, physics, senses
        self._plans: list[Plan] = []

    def _plan(self, parts: Sequence[MergedSegment[int]]) -> None:
        """Find out for each part which senses of which infants can be sampled at once."""
        rows = list(self._segments)
        worlds = list(dict.fromkeys(self._world_of[row] for row in rows))
        self._plans = []
        for part in parts:
            is_sampled = any(segment.samples for _, segment in part.ended)
            groups = self._groups(worlds) if is_sampled else [worlds]
            samplings = [
                self._samplings([item for item in part.ended if self._world_of[item[0]] in members])
                for members in map(set, groups)
            ]
            self._plans.append(Plan(groups, samplings))

    def _simulate(self, number: int, part: MergedSegment[int]) -> None:
        """Make the physics steps of a part in threads, and sample each group of worlds as soon as it has made them."""
        plan = self._plans[number]
        with closing(self._physics.step(plan.groups, part.physics_steps)) as stepped:
            for samplings, group in zip(plan.samplings, stepped, strict=True):
                for row in self._accompanied:
                    if self._world_of[row] in group and row in self._segments:
                        self._schedules[row].companions.after_step(self._datas[row])
                self._sample(samplings)

    def _sample(self, samplings: Sequence[Sampling]) -> None:
        """Sample senses; infants that are read by several share what is read of their worlds."""
        worlds = {}
        for sampling in samplings:
            rows = sampling.infants
            if rows not in worlds:
                read = partial(self._physics.array, infants=[self._world_of[row] for row in rows])
                worlds[rows] = worlds_of_many([self._datas[row] for row in rows], read)
            samples = sampling.read(worlds[rows])
            if sampling.is_noisy:
                samples = [
                    self._schedules[row].disturb(sampling.name, sample.copy(), self._datas[row])
                    for row, sample in zip(rows, samples, strict=True)
                ]
            for delayed, sample in zip(sampling.delayed, samples, strict=True):
                for line in delayed:
                    line.send(sample)

    def _groups(self, worlds: list[int]) -> list[list[int]]:
        """Return worlds in two groups, if several threads share so many that it is worth while.

        While the first group is sampled, other threads step the last one; while that is sampled, they have nothing to
        do. So the last group is as small as keeps them busy: a quarter of all for two threads, half for many.
        """
        threads = self._physics.threads
        if threads == 1 or len(worlds) < LEAST:
            return [worlds]
        cut = len(worlds) * (threads + 1) // (2 * threads)
        return [worlds[:cut], worlds[cut:]]

    def _samplings(self, due: Sequence[tuple[int, Segment]]) -> list[Sampling]:
        """Return what is sampled at the ends of some segments: each sense of all infants that can be read together."""
        parts: defaultdict[tuple[str, int], dict[int, tuple[DelayedSamples, ...]]] = defaultdict(dict)
        for row, segment in due:
            for name, delayed in segment.samples:
                parts[name, self._senses[name].kinds[row]][row] = delayed
        return [
            Sampling(
                name,
                tuple(delayed),
                self._senses[name].reader(list(delayed)),
                list(delayed.values()),
                any(self._schedules[row].is_noisy(name) for row in delayed),
            )
            for (name, _), delayed in parts.items()
        ]
