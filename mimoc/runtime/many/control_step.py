"""One control step of many infants: their segments side by side, so that all make their physics steps together."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.delays.schedule import Schedule, Segment
from mimoc.delays.timing import Samples
from mimoc.runtime.many.physics import Physics
from mimoc.senses.joined import Joined

Due = list[tuple[int, tuple[Samples, ...]]]
"""Infants whose sense is sampled, with the delays that the sample of each goes into."""
GROUPS, LEAST = 2, 8
"""Into how many groups infants are cut, at most, and how many are in each, at least: one group is sampled while others
make their physics steps."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a control step in which no infant's command arrives and no sense is sampled."""

    begun: Sequence[tuple[int, Segment]]
    """The segments that begin at its start, with their infants."""
    physics_steps: int
    groups: Sequence[Sequence[int]]
    """All infants."""
    samples: Sequence[Mapping[str, Due]]
    """Senses of each group to be sampled at its end, by name."""


class ControlStep:
    """Goes through control steps of some of n infants."""

    def __init__(self, schedules: Sequence[Schedule], physics: Physics, senses: Mapping[str, Joined]):
        """Join the schedules of all infants, which have the same senses and the same control step."""
        self._schedules, self._physics, self._senses = schedules, physics, senses
        self._segments: dict[int, tuple[Segment, ...]] = {}
        self._stretches: list[Stretch] = []

    def __call__(self, actions: npt.NDArray[Any], infants: Sequence[int]) -> None:
        """Go through a control step of some infants.

        Args:
            actions: Of all n infants, shape (n, actuators).
            infants: Those that make a step; who is alike should stand side by side.
        """
        schedules, datas = self._schedules, self._physics.datas
        segments = {infant: schedules[infant].begin(actions[infant], datas[infant]) for infant in infants}
        if segments != self._segments:  # Without jitter, they are the same objects in each control step.
            self._segments, self._stretches = segments, side_by_side(segments, self._physics.threads)
        for stretch in self._stretches:
            for infant, segment in stretch.begun:
                schedules[infant].command(segment, datas[infant])
            with closing(self._physics.step(stretch.groups, stretch.physics_steps)) as stepped:
                for samples, _ in zip(stretch.samples, stepped, strict=True):
                    for name, due in samples.items():
                        self._sample(name, due)

    def _sample(self, name: str, due: Due) -> None:
        """Sample a sense of some infants."""
        datas = self._physics.datas
        samples = self._senses[name].read(self._physics, [infant for infant, _ in due])
        for (infant, delayed), sample in zip(due, samples, strict=True):
            disturbed = self._schedules[infant].disturb(name, sample, datas[infant])
            for each in delayed:
                each.send(disturbed)


def side_by_side(segments: Mapping[int, Sequence[Segment]], threads: int) -> list[Stretch]:
    """Return the segments of some infants, cut wherever one of any infant ends."""
    begun: defaultdict[int, list[tuple[int, Segment]]] = defaultdict(list)
    due: defaultdict[int, dict[str, Due]] = defaultdict(dict)
    for infant, own in segments.items():
        now = 0
        for segment in own:
            begun[now].append((infant, segment))
            now += segment.physics_steps
            for name, delayed in segment.samples:
                due[now].setdefault(name, []).append((infant, delayed))
        begun.setdefault(now, [])
    everyone = list(segments)
    stretches = []
    for start, end in pairwise(sorted(begun)):
        count = min(GROUPS, len(everyone) // LEAST) if threads > 1 and due[end] else 1
        groups = [part.tolist() for part in np.array_split(everyone, max(count, 1))]
        stretches.append(Stretch(begun[start], end - start, groups, [_of_group(due[end], group) for group in groups]))
    return stretches


def _of_group(due: Mapping[str, Due], group: Sequence[int]) -> dict[str, Due]:
    """Return the senses of some infants that are sampled."""
    inside = set(group)
    found = {name: [each for each in infants if each[0] in inside] for name, infants in due.items()}
    return {name: infants for name, infants in found.items() if infants}
