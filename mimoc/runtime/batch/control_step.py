"""One control step of many infants: their segments side by side, so that all make their physics steps together."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.delays.merging import merge_segments
from mimoc.delays.schedule import Segment
from mimoc.delays.signals import DelayedSamples
from mimoc.runtime.batch.physics import ThreadedPhysics
from mimoc.runtime.batch.senses import BatchSense, Read
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.worlds import worlds_of_many
from mimoc.senses.sense import FloatArray

LEAST = 16
"""Number of infants from which on they are cut into two groups: one is sampled while the other makes physics steps."""


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
class BatchSegment:
    """A part of a control step in which no infant's command arrives and no sense is sampled."""

    begun: Sequence[tuple[int, Segment]]
    """The segments that begin at its start, with their infants."""
    physics_steps: int
    groups: Sequence[Sequence[int]]
    """All infants."""
    samplings: Sequence[Sequence[Sampling]]
    """What is sampled of each group at its end."""


class ControlStep:
    """Goes through control steps of some of n infants."""

    def __init__(self, infants: Sequence[InfantEnv], physics: ThreadedPhysics, senses: Mapping[str, BatchSense]):
        """Join the schedules of all infants, which have the same senses and the same control step."""
        self._schedules = [infant.schedule for infant in infants]
        self._actuations = [infant.actuation for infant in infants]
        self._accompanied = {index for index, schedule in enumerate(self._schedules) if schedule.companions}
        self._is_plain = all(actuation.command is None for actuation in self._actuations)
        self._physics, self._senses = physics, senses
        self._segments: dict[int, tuple[Segment, ...]] = {}
        self._merged: list[BatchSegment] = []

    def __call__(self, actions: npt.NDArray[Any], infants: Sequence[int]) -> None:
        """Go through a control step of some infants, those alike side by side; actions are of all n, shape (n, m)."""
        schedules, datas = self._schedules, self._physics.datas
        controls = self._controls(actions, infants)
        segments = {infant: schedules[infant].begin(controls[infant]) for infant in infants}
        if segments != self._segments:  # Without jitter, they are the same objects in each control step.
            self._segments, self._merged = segments, self._merge_segments(segments)
        for merged in self._merged:
            for infant, segment in merged.begun:
                schedules[infant].command(segment, datas[infant])
            with closing(self._physics.step(merged.groups, merged.physics_steps)) as stepped:
                for samplings, group in zip(merged.samplings, stepped, strict=True):
                    for infant in self._accompanied.intersection(group) if self._accompanied else ():
                        schedules[infant].companions.after_step(datas[infant])
                    self._sample(samplings)

    def _controls(self, actions: npt.NDArray[Any], infants: Sequence[int]) -> FloatArray:
        """Return the controls of all infants, shape (n, actuators), of which those of some are needed."""
        controls = actions.astype(np.float64)
        if not self._is_plain:
            for infant in infants:
                controls[infant] = self._schedules[infant].controls(actions[infant], self._physics.datas[infant])
        return controls

    def _sample(self, samplings: Sequence[Sampling]) -> None:
        """Sample senses; infants that are read by several share what is read of their worlds."""
        datas, array, worlds = self._physics.datas, self._physics.array, {}
        for sampling in samplings:
            infants = sampling.infants
            if infants not in worlds:
                worlds[infants] = worlds_of_many([datas[infant] for infant in infants], partial(array, infants=infants))
            samples = sampling.read(worlds[infants])
            if sampling.is_noisy:
                samples = [
                    self._schedules[infant].disturb(sampling.name, sample.copy(), datas[infant])
                    for infant, sample in zip(infants, samples, strict=True)
                ]
            for delayed, sample in zip(sampling.delayed, samples, strict=True):
                for line in delayed:
                    line.send(sample)

    def _merge_segments(self, segments: Mapping[int, Sequence[Segment]]) -> list[BatchSegment]:
        """Return the segments of some infants, cut wherever one of any infant ends."""
        merged = []
        for part in merge_segments(segments):
            are_sampled = any(segment.samples for _, segment in part.ended)
            groups = self._groups(list(segments)) if are_sampled else [list(segments)]
            samplings = [
                self._samplings([item for item in part.ended if item[0] in members]) for members in map(set, groups)
            ]
            merged.append(BatchSegment(part.begun, part.physics_steps, groups, samplings))
        return merged

    def _groups(self, infants: list[int]) -> list[list[int]]:
        """Return infants in two groups, if several threads share so many that it is worth while.

        While the first group is sampled, other threads step the last one; while that is sampled, they have nothing to
        do. So the last group is as small as keeps them busy: a quarter of all for two threads, half for many.
        """
        threads = self._physics.threads
        if threads == 1 or len(infants) < LEAST:
            return [infants]
        cut = len(infants) * (threads + 1) // (2 * threads)
        return [infants[:cut], infants[cut:]]

    def _samplings(self, due: Sequence[tuple[int, Segment]]) -> list[Sampling]:
        """Return what is sampled at the ends of some segments: each sense of all infants that can be read together."""
        parts: defaultdict[tuple[str, int], dict[int, tuple[DelayedSamples, ...]]] = defaultdict(dict)
        for infant, segment in due:
            for name, delayed in segment.samples:
                parts[name, self._senses[name].kinds[infant]][infant] = delayed
        return [
            Sampling(
                name,
                tuple(delayed),
                self._senses[name].reader(list(delayed)),
                list(delayed.values()),
                any(self._schedules[infant].is_noisy(name) for infant in delayed),
            )
            for (name, _), delayed in parts.items()
        ]
