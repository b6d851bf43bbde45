"""The control steps of several infants side by side: their segments, cut wherever one of any infant ends."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, TypeVar

from mimoc.runtime.delays.schedule import Segment

Infant = TypeVar("Infant")


@dataclass(frozen=True, slots=True)
class MergedSegment(Generic[Infant]):
    """A part of a control step in which no infant's command arrives and no sense is sampled.

    anna    |--- 2 ---|--- 2 ---|
    ben     |-- 1 -|----- 3 ----|
    merged  |  1   |1 |    2    |
    """

    begun: Sequence[tuple[Infant, Segment]]
    """The segments that begin at its start, with their infants."""
    physics_steps: int
    ended: Sequence[tuple[Infant, Segment]]
    """The segments that end at its end, likewise."""


def merge_segments(segments: Mapping[Infant, Sequence[Segment]]) -> list[MergedSegment[Infant]]:
    """Return the segments of some infants, whose control steps are as long as each other's, side by side."""
    begun: defaultdict[int, list[tuple[Infant, Segment]]] = defaultdict(list)
    ended: defaultdict[int, list[tuple[Infant, Segment]]] = defaultdict(list)
    for infant, parts in segments.items():
        time = 0
        for segment in parts:
            begun[time].append((infant, segment))
            time += segment.physics_steps
            ended[time].append((infant, segment))
    cuts = sorted({*begun, *ended})
    return [MergedSegment(begun[start], end - start, ended[end]) for start, end in pairwise(cuts)]
