"""Simulations side by side in threads, whose senses are read as arrays of all their infants."""

import os
from collections import defaultdict
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from queue import SimpleQueue
from threading import Lock
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.classes import class_name
from mimoc.base.kinds import function_of
from mimoc.bundle.model import BREAKDOWNS
from mimoc.runtime.contract import check_rows
from mimoc.runtime.control_step import ControlStep, MergedSegment, Segment, arrived
from mimoc.runtime.delays import DelayedSamples
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation, Sample, Sense, Vector
from mimoc.runtime.simulation import Simulation
from mimoc.runtime.term import differing_field, stack_terms, take_rows
from mimoc.runtime.worlds import Worlds, worlds_of_many
from mimoc.schema.kinds import SENSES


class ThreadedPhysics:
    """The physics of n simulations in threads, which use all cores, as MuJoCo releases Python's lock while it steps."""

    def __init__(self, models: Sequence[mujoco.MjModel], datas: Sequence[mujoco.MjData], threads: int | None = None):
        self.models, self.datas = list(models), list(datas)
        self.threads = threads or usable_threads()
        self._pool: ThreadPoolExecutor | None = None
        self._process = 0
        self._views: dict[str, list[FloatArray]] = {}
        self._warnings = [data.warning.number for data in datas]

    def step(self, groups: Sequence[Sequence[int]], steps: int) -> Generator[Sequence[int], None, None]:
        """Make physics steps of infants; yield each group once it has made them, while threads go on with others."""
        return self._share(partial(self._step_one, steps=steps), groups)

    def in_threads(self, function: Callable[[int], Sample], infants: Sequence[int]) -> list[Sample]:
        """Return what a function returns for some infants, called in any thread."""
        samples: dict[int, Sample] = {}

        def call(infant: int) -> None:
            samples[infant] = function(infant)

        for _ in self._share(call, [infants]):
            pass
        return [samples[infant] for infant in infants]

    def _share(
        self, function: Callable[[int], None], groups: Sequence[Sequence[int]]
    ) -> Generator[Sequence[int], None, None]:
        """Call a function for some infants in all threads; yield each group of them as soon as all of it is done."""
        waiting = ((infant, group) for group, infants in enumerate(groups) for infant in infants)
        turn = Lock()
        done = [SimpleQueue[int]() for _ in groups]

        def call_next() -> bool:
            with turn:
                infant, group = next(waiting, (None, 0))
            if infant is not None:
                try:
                    function(infant)
                finally:  # Whoever waits for an infant that failed would wait forever.
                    done[group].put(infant)
            return infant is not None

        def call_all() -> None:
            while call_next():
                pass

        futures = self._help(call_all, min(self.threads, sum(map(len, groups))) - 1)
        try:
            for finished, infants in zip(done, groups, strict=True):
                while finished.qsize() < len(infants) and call_next():
                    pass
                for _ in infants:
                    finished.get()
                yield infants
        finally:  # Also if the caller fails meanwhile: nobody steps an infant behind its back.
            for future in futures:
                future.result()

    def array(self, field: str, infants: Sequence[int]) -> FloatArray:
        """Return a field of `MjData` whose size never changes, such as `qpos`, of k infants that are alike."""
        if field not in self._views:
            self._views[field] = [getattr(data, field) for data in self.datas]
        views = [self._views[field][infant] for infant in infants]
        return np.concatenate(views).reshape(len(views), *views[0].shape)

    def are_unstable(self) -> list[bool]:
        """Return of each infant whether its simulation has become unstable since its reset; see `is_unstable`."""
        counts = np.concatenate(self._warnings).reshape(len(self.datas), -1)
        return [any(warnings) for warnings in counts[:, BREAKDOWNS].tolist()]

    def replace(self, infant: int, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Put another model and state in place of an infant's, as when it has grown."""
        self.models[infant], self.datas[infant] = model, data
        self._warnings[infant] = data.warning.number
        for field, views in self._views.items():
            views[infant] = getattr(data, field)

    def close(self) -> None:
        """End the threads; closing twice is fine."""
        if self._pool:
            self._pool.shutdown()

    def _help(self, function: Callable[[], None], helpers: int) -> list[Future[None]]:
        """Call a function in other threads too; a forked process starts threads of its own."""
        if helpers > 0 and self._process != os.getpid():
            self._pool, self._process = ThreadPoolExecutor(self.threads - 1), os.getpid()
        return [self._pool.submit(function) for _ in range(helpers)] if self._pool else []

    def _step_one(self, infant: int, steps: int) -> None:
        """Make physics steps of one infant; an error of MuJoCo counts as unstable."""
        data = self.datas[infant]
        try:
            mujoco.mj_step(self.models[infant], data, steps)
        except mujoco.FatalError:
            data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number += 1


def usable_threads() -> int:
    """Return how many threads this process may run at once: in a container, fewer than there are cores."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


Read = Callable[[Worlds], Sequence[Sample]]
"""Returns the samples of the k infants that it is for, from their worlds: new arrays, or rows of one."""
COORDINATES = ("nq", "nv", "na", "nu")
ELEMENTS = ("nbody", "njnt", "ngeom", "nsite", "ncam", "nlight", "ntendon", "nmocap", "neq")
SIZES = (*COORDINATES, *ELEMENTS, "nsensordata", "nuserdata")  # They determine the shapes of the fields of `MjData`.


class BatchSense:
    """A sense of n infants, which has the same name for all."""

    def __init__(self, name: str, senses: Sequence[Sense], models: Sequence[mujoco.MjModel], physics: ThreadedPhysics):
        """Find out which infants can be read together: those with terms of equal addresses in models of equal size."""
        self._name = name
        self._senses = senses
        self._physics = physics
        self.kinds = _kinds(senses, models)  # The kind of each infant; those of the same kind can be read together.
        self._stacked: dict[int, tuple[list[int], Any]] = {}  # The infants of a kind and their joint term, by kind.
        for kind in set(self.kinds):
            members = [infant for infant, kind_of_infant in enumerate(self.kinds) if kind_of_infant == kind]
            terms: list[Any] = [senses[infant].term for infant in members]
            if terms[0] is not None:
                self._stacked[kind] = members, stack_terms(terms)
        self._bounds = None
        if all(isinstance(sense, Vector) and type(sense).observe is Vector.observe for sense in senses):
            vectors: Sequence[Any] = senses
            self._bounds = [np.stack([getattr(sense, bound) for sense in vectors]) for bound in ("low", "high")]

    def reader(self, infants: Sequence[int]) -> Read:
        """Return a function that reads some infants of one kind."""
        senses: list[Any] = [self._senses[infant] for infant in infants]
        if senses[0].term is not None:
            members, stacked = self._stacked[self.kinds[infants[0]]]
            term = take_rows(stacked, np.searchsorted(members, infants))
            return partial(_rows, self._name, term, len(infants))
        module = SENSES[self._name].many if self._name in SENSES else None
        if module and (read := function_of(module, "join")(senses)):
            return read
        if all(sense.reads_in_threads for sense in senses):
            in_threads = self._physics.in_threads
            indices = range(len(senses))
            return lambda worlds: in_threads(lambda index: senses[index](worlds.datas[index]), indices)
        return lambda worlds: [sense(data) for sense, data in zip(senses, worlds.datas, strict=True)]

    def observe(self, samples: Sequence[Sample]) -> Observation:
        """Return what each of the n infants observes of a sample, as new arrays with a leading axis of n."""
        if self._bounds:
            low, high = self._bounds
            observed = np.concatenate(samples).reshape(low.shape)
            np.maximum(observed, low, out=observed)
            np.minimum(observed, high, out=observed)
            return {self._name: observed.astype(np.float32)}
        spaces = self._senses[0].spaces
        observation = {name: np.empty((len(samples), *space.shape), space.dtype) for name, space in spaces.items()}
        for index, (sense, sample) in enumerate(zip(self._senses, samples, strict=True)):
            sense.write(sample, {name: array[index] for name, array in observation.items()})
        return observation


def _rows(name: str, term: Any, infants: int, worlds: Worlds) -> list[Sample]:
    samples = list(term(worlds))
    if len(samples) != infants:
        check_rows(f"sense '{name}': the term {class_name(term)}", np.array(samples), infants)
    return samples


def _kinds(senses: Sequence[Sense], models: Sequence[mujoco.MjModel]) -> list[int]:
    """Return the number of each infant's kind: infants of the same kind can be read together."""
    examples: list[tuple[Sense, tuple[int, ...]]] = []  # The first sense of each kind, and the sizes of its model.
    kinds: list[int] = []
    for sense, model in zip(senses, models, strict=True):
        sizes = tuple(getattr(model, name) for name in SIZES)
        alike = (
            kind
            for kind, (example, example_sizes) in enumerate(examples)
            if example_sizes == sizes and _is_alike(example, sense)
        )
        kind = next(alike, None)
        if kind is None:
            kind = len(examples)
            examples.append((sense, sizes))
        kinds.append(kind)
    return kinds


def _is_alike(first: Sense, other: Sense) -> bool:
    if first.term is None or other.term is None:
        return first.term is other.term
    return differing_field([first.term, other.term]) is None


MIN_SPLIT = 16  # Fewest worlds in two groups, of which one is sampled while the other is stepped.


@dataclass(frozen=True, slots=True)
class Sampling:
    """A sense that is sampled of some infants at once."""

    name: str
    infants: tuple[int, ...]
    read: Read
    delayed: Sequence[tuple[DelayedSamples, ...]]  # The delays that the sample of each infant goes into.
    is_noisy: bool


@dataclass(frozen=True, slots=True)
class Plan:
    """How one part of a control step is simulated and sampled."""

    groups: Sequence[Sequence[int]]
    samplings: Sequence[Sequence[Sampling]]  # Senses that are sampled of the infants of each group at its end.


class Batch:
    """Simulations of infants with equal spaces; rows are infants in order of worlds, each to the bit as it is alone."""

    def __init__(self, simulations: Sequence[Simulation], threads: int | None = None):
        self.simulations = tuple(simulations)
        self.infants = tuple(infant for world in self.simulations for infant in world.infants.values())
        self.world_of = [index for index, world in enumerate(self.simulations) for _ in world.infants]
        rows = iter(range(len(self.infants)))
        self.rows_of = [{name: next(rows) for name in world.infants} for world in self.simulations]
        models = [world.model for world in self.simulations]
        datas = [world.data for world in self.simulations]
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
        """Bind the models that simulations have got by growing or in another scene."""
        changed = [
            index
            for index, world in enumerate(self.simulations)
            if world.data is not self.physics.datas[index] or world.model is not self.physics.models[index]
        ]
        for index in changed:
            self.physics.replace(index, self.simulations[index].model, self.simulations[index].data)
        if changed:
            self._bind()

    def _bind(self) -> None:
        """Join the parts of all infants; worlds of the same bundle come one after another."""
        first_with: dict[int, int] = {}  # Index of the first world with a bundle, by the identity of the bundle.
        for index, world in enumerate(self.simulations):
            first_with.setdefault(id(world.bundle), index)
        self.order = sorted(
            range(len(self.simulations)), key=lambda index: first_with[id(self.simulations[index].bundle)]
        )
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
        """Return the controls of all infants, shape (n, commands); only those of some rows are needed."""
        controls = actions.astype(np.float64)
        if not self._is_plain:
            for row in rows:
                infant = self.infants[row]
                controls[row] = infant.schedule.controls(actions[row], infant.data)
        return controls


class BatchStep(ControlStep[int]):
    """The control step of rows of a batch."""

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
        self._world_of = world_of
        self._physics = physics
        self._senses = senses
        self._plans: list[Plan] = []

    def _plan(self, parts: Sequence[MergedSegment[int]]) -> None:
        """Find out which senses of which infants can be sampled at once at the end of each part."""
        rows = list(self._segments)
        worlds = list(dict.fromkeys(self._world_of[row] for row in rows))
        self._plans = []
        for part in parts:
            is_sampled = any(segment.samples for _, segment in part.ended)
            groups = self._groups(worlds) if is_sampled else [worlds]
            samplings = [
                self._samplings([(row, segment) for row, segment in part.ended if self._world_of[row] in members])
                for members in map(set, groups)
            ]
            self._plans.append(Plan(groups, samplings))

    def _simulate(self, number: int, part: MergedSegment[int]) -> None:
        """Make the physics steps of a part in threads, and sample each group of worlds once it has made them."""
        plan = self._plans[number]
        with closing(self._physics.step(plan.groups, part.physics_steps)) as stepped:
            for samplings, group in zip(plan.samplings, stepped, strict=True):
                for row in self._accompanied:
                    if self._world_of[row] in group and row in self._segments:
                        self._schedules[row].companions.after_step(self._datas[row])
                self._sample(samplings)

    def _sample(self, samplings: Sequence[Sampling]) -> None:
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
                for delay in delayed:
                    delay.send(sample)

    def _groups(self, worlds: list[int]) -> list[list[int]]:
        """Return worlds in two groups, if several threads share so many that it is worth while.

        While the first group is sampled, other threads step the last one; while that is sampled, they have nothing to
        do. So the last group is as small as keeps them busy: a quarter of all for two threads, half for many.
        """
        threads = self._physics.threads
        if threads == 1 or len(worlds) < MIN_SPLIT:
            return [worlds]
        cut = len(worlds) * (threads + 1) // (2 * threads)
        return [worlds[:cut], worlds[cut:]]

    def _samplings(self, due: Sequence[tuple[int, Segment]]) -> list[Sampling]:
        # The delays of each row, by the sense that is sampled and the kind of the infants that are read together.
        delays: defaultdict[tuple[str, int], dict[int, tuple[DelayedSamples, ...]]] = defaultdict(dict)
        for row, segment in due:
            for name, delayed in segment.samples:
                delays[name, self._senses[name].kinds[row]][row] = delayed
        return [
            Sampling(
                name,
                infants=tuple(delayed),
                read=self._senses[name].reader(list(delayed)),
                delayed=list(delayed.values()),
                is_noisy=any(self._schedules[row].is_noisy(name) for row in delayed),
            )
            for (name, _), delayed in delays.items()
        ]
