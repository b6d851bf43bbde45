"""Delay lines on a device: what is sampled or commanded now arrives later, for each number and infant after its delay.

A line is a ring of slots, one for each control step that the longest delay of any infant takes and one more: with a
delay of L control steps, what was sent L steps ago is in slot (clock - L) modulo (L + 1), which is the next to be
written. So a reset only fills all slots. With L = 2:

    clock      0   1   2   3   4
    sent to    0   1   2   0   1
    arrives    -   -   0   1   2      what was sent at clock 0, 1, 2
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import torch
import warp as wp

from mimoc.delays.signals import Mask
from mimoc.senses.sense import IntArray

Rows = torch.Tensor | slice


class Part(NamedTuple):
    """Numbers of a signal that have the same delay as each other in every infant."""

    columns: Rows
    slots: torch.Tensor
    """One more than the whole control steps of the delay, shape (worlds,)."""
    worlds_by_rest: dict[int, Rows]
    """The worlds whose delay takes some physics steps more."""
    ring: torch.Tensor
    """What is on its way, shape (slots, worlds, columns)."""


class Line:
    """What is on its way of one signal of all infants."""

    def __init__(self, delays: IntArray, period: int, body_of_world: wp.array, dtype: type = wp.float32):
        """Begin with nothing on the way.

        Args:
            delays: In physics steps, shape (bodies, n).
            period: Physics steps in a control step.
            body_of_world: Which body lives in each world, shape (worlds,).
            dtype: Of the numbers.
        """
        body = body_of_world.numpy()
        self.rests: IntArray = np.unique(delays % period)
        """By how many physics steps delays are longer than whole control steps."""
        self.entering = wp.zeros((len(body), delays.shape[1]), dtype=dtype)
        """What is sampled or commanded now, shape (worlds, n)."""
        self._entering = wp.to_torch(self.entering)
        device = self._entering.device
        self._worlds = torch.arange(len(body), device=device)
        self._parts: list[Part] = []
        for delay in np.unique(delays, axis=1).T:
            slots, rests = delay[body] // period + 1, delay[body] % period
            columns = _rows((delays == delay[:, None]).all(axis=0), device)
            ring = torch.zeros_like(self._entering[:, columns]).repeat(int(slots.max()), 1, 1)
            worlds_by_rest = {int(rest): _rows(rests == rest, device) for rest in np.unique(rests)}
            self._parts.append(Part(columns, torch.as_tensor(slots, device=device), worlds_by_rest, ring))

    def send(self, clock: torch.Tensor, rest: int | None = None) -> None:
        """Send those numbers whose delay is *rest* physics steps more than whole control steps; None is all of them."""
        for part, rows in self._due(rest):
            slots = (clock % part.slots)[rows]
            part.ring[slots, self._worlds[rows]] = self._entering[:, part.columns][rows]

    def arrive(self, clock: torch.Tensor, rest: int | None = None) -> Iterator[tuple[Rows, Rows, torch.Tensor]]:
        """Yield worlds, columns, and what has arrived there; of those numbers that `send` sends."""
        for part, rows in self._due(rest):
            slots = ((clock + 1) % part.slots)[rows]
            yield rows, part.columns, part.ring[slots, self._worlds[rows]]

    def fill(self, begin: torch.Tensor, start: torch.Tensor) -> None:
        """Forget all that is on the way in worlds that begin, shape (worlds,); rows of *start* come out until then."""
        for part in self._parts:
            torch.where(begin[:, None], start[:, part.columns], part.ring, out=part.ring)

    def _due(self, rest: int | None) -> Iterator[tuple[Part, Rows]]:
        for part in self._parts:
            if rest is None:
                yield part, slice(None)
            elif rest in part.worlds_by_rest:
                yield part, part.worlds_by_rest[rest]


def _rows(mask: Mask, device: torch.device) -> Rows:
    """Return where a mask is true, as a slice if it is everywhere."""
    return slice(None) if mask.all() else torch.as_tensor(np.flatnonzero(mask), device=device)
