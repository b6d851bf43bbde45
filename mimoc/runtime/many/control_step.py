"""One control step of many infants: their segments side by side, so that all make their physics steps together."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy.typing as npt

from mimoc.delays.schedule import Schedule, Segment
from mimoc.delays.timing import Samples
from mimoc.runtime.many.physics import Physics
from mimoc.senses.joined import Joined

Due = list[tuple[int, tuple[Samples, ...]]]
"""Infants whose sense is sampled, with the delays that the sample of each goes into."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a control step in which no infant's command arrives and no sense is sampled."""

    begun: Sequence[tuple[int, Segment]]
    """The segments that begin at its start, with their infants."""
    physics_steps: int
    samples: Mapping[str, Due]
    """Senses to be sampled at its end, by name."""


class ControlStep:
    """Goes through control steps of some of n infants."""

    def __init__(self, schedules: Sequence[Schedule], physics: Physics, senses: Mapping[str, Joined]):
        """Join the schedules of all infants, which have the same senses and the same control step."""
        self._schedules, self._physics, self._senses = schedules, physics, senses
        self._segments: dict[int, tuple[Segment, ...]] = {}
        self._stretches: list[Stretch] = []

    def __call__(self, actions: npt.NDArray[Any], infants: Sequence[int]) -> set[int]:
        """Go through a control step of some infants; return those whose simulation MuJoCo could not continue.

        Args:
            actions: Of all n infants, shape (n, actuators).
            infants: Those that make a step.
        """
        schedules, datas, failed = self._schedules, self._physics.datas, set[int]()
        segments = {infant: schedules[infant].begin(actions[infant], datas[infant]) for infant in infants}
        if segments != self._segments:  # Without jitter, they are the same objects in each control step.
            self._segments, self._stretches = segments, side_by_side(segments)
        for stretch in self._stretches:
            for infant, segment in stretch.begun:
                schedules[infant].command(segment, datas[infant])
            failed.update(self._physics.step(infants, stretch.physics_steps))
            for name, due in stretch.samples.items():
                self._sample(name, due)
        return failed

    def _sample(self, name: str, due: Due) -> None:
        """Sample a sense of some infants."""
        datas = self._physics.datas
        samples = self._senses[name].read(self._physics, [infant for infant, _ in due])
        for (infant, delayed), sample in zip(due, samples, strict=True):
            disturbed = self._schedules[infant].disturb(name, sample, datas[infant])
            for each in delayed:
                each.send(disturbed)


def side_by_side(segments: Mapping[int, Sequence[Segment]]) -> list[Stretch]:
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
    return [Stretch(begun[start], end - start, due[end]) for start, end in pairwise(sorted(begun))]
