"""The control step: commands arrive, physics is simulated, senses are sampled, for any infants in any simulations."""

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, TypeVar

import mujoco

from mimoc.bundle.model import out_of_memory
from mimoc.runtime.delays.schedule import Schedule, Segment
from mimoc.runtime.sense import FloatArray

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True, slots=True)
class MergedSegment(Generic[Key]):
    """A part of a control step in which no infant's command arrives and no sense is sampled.

    anna    |--- 2 ---|--- 2 ---|
    ben     |-- 1 -|----- 3 ----|
    merged  |  1   |1 |    2    |
    """

    begun: Sequence[tuple[Key, Segment]]
    """The segments that begin at its start, with their infants."""
    physics_steps: int
    ended: Sequence[tuple[Key, Segment]]
    """The segments that end at its end, likewise."""


def merge_segments(segments: Mapping[Key, Sequence[Segment]]) -> list[MergedSegment[Key]]:
    """Return the segments of some infants, whose control steps are as long as each other's, side by side."""
    begun: defaultdict[int, list[tuple[Key, Segment]]] = defaultdict(list)
    ended: defaultdict[int, list[tuple[Key, Segment]]] = defaultdict(list)
    for infant, parts in segments.items():
        time = 0
        for segment in parts:
            begun[time].append((infant, segment))
            time += segment.physics_steps
            ended[time].append((infant, segment))
    cuts = sorted({*begun, *ended})
    return [MergedSegment(begun[start], end - start, ended[end]) for start, end in pairwise(cuts)]


class ControlStep(Generic[Key]):
    """Goes through control steps of some infants, cut wherever a command of one arrives or one of its senses is due.

    These are all infants of one simulation; `BatchStep` is for those of many.
    """

    def __init__(self, schedules: Mapping[Key, Schedule], datas: Mapping[Key, mujoco.MjData]):
        """Join the schedules of infants, whose control steps are equally long, and the states that they are in."""
        self._schedules, self._datas = schedules, datas
        self._data = next(iter(datas.values()))
        self._model = self._data.model
        self._segments: dict[Key, tuple[Segment, ...]] = {}
        self._parts: Sequence[MergedSegment[Key]] = ()

    def __call__(self, controls: Mapping[Key, FloatArray]) -> None:
        """Go through a control step of some infants with these controls; see `Schedule.controls`."""
        schedules, datas = self._schedules, self._datas
        segments = {key: schedules[key].begin(given) for key, given in controls.items()}
        if segments != self._segments:  # Without jitter, they are the same objects in each control step.
            self._segments, self._parts = segments, merge_segments(segments)
            self._plan(self._parts)
        for number, part in enumerate(self._parts):
            for key, segment in part.begun:
                schedules[key].command(segment, datas[key])
            self._simulate(number, part)

    def _plan(self, parts: Sequence[MergedSegment[Key]]) -> None:
        """Prepare for the parts of the control steps to come."""

    def _simulate(self, number: int, part: MergedSegment[Key]) -> None:
        """Make the physics steps of a part, and sample what is due at its end."""
        try:
            mujoco.mj_step(self._model, self._data, part.physics_steps)
        except mujoco.FatalError as error:
            raise out_of_memory(error) from None
        for key, segment in part.ended:
            self._schedules[key].sample(segment, self._data)
