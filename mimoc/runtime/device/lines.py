"""Delay lines of all infants on a device.

What is sampled or commanded now arrives later, for each number and infant after its delay. A delay line is a ring of
slots, one for each control step that the longest delay of any infant takes and one more: with a delay of L control
steps, what was sent L steps ago is in slot (clock - L) modulo (L + 1), which is the next to be written. So a reset only
fills all slots. With L = 2:

    clock      0   1   2   3   4
    sent to    0   1   2   0   1
    arrives    -   -   0   1   2      what was sent at clock 0, 1, 2

Where delays vary, a ring has a slot for each physics step instead, and what arrives is looked up by the delay of now.

The history of a line is what was sent last, by age: the newest first, each number as far back as it is still on its way
or has just arrived. It says nothing of clocks and slots, so that it can be kept, and put into lines with other delays.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import torch

from mimoc.runtime.delays.signals import Mask
from mimoc.runtime.device.arrays import put, where_worlds
from mimoc.runtime.device.states import Slot
from mimoc.runtime.sense import IntArray

Rows = torch.Tensor | slice
Uniforms = Callable[[Sequence[int]], torch.Tensor]
"""From a shape, (worlds, ...), to random numbers from 0 to less than 1."""


class Part(NamedTuple):
    """Numbers of a signal that have the same delay as each other in every infant."""

    columns: Rows
    slots: torch.Tensor
    """How many slots are used, shape (worlds,)."""
    worlds_by_rest: dict[int, Rows]
    """The worlds whose delay takes some physics steps more than whole control steps."""
    ring: torch.Tensor
    """What is on its way, shape (slots, worlds, columns)."""
    delay: torch.Tensor
    """In physics steps, shape (worlds,)."""
    channel: torch.Tensor
    """Which of the deviations of each world is added to it, if delays vary, shape (worlds,)."""


class Delays(NamedTuple):
    """The delays of the n numbers of a signal, in physics steps; shape (n,), or (bodies, n)."""

    steps: IntArray
    jitter: IntArray
    """How far the delay varies at most."""
    channel: IntArray
    """Numbers of one channel vary together: 0, and 1 for those in the legs where they have a delay of their own."""


class Line:
    """What is on its way of one signal of all infants."""

    def __init__(self, delays: Delays, period: int, body: torch.Tensor, dtype: torch.dtype = torch.float32):
        """Begin with nothing on the way; the control step is in physics steps, delays are those of each body."""
        self._period, self._worlds = period, torch.arange(len(body), device=body.device)
        self.rests: IntArray = self._rests(delays.steps)
        """By how many physics steps delays are longer than whole control steps."""
        self._parts: list[Part] = []
        bodies, which = len(delays.steps), body.tolist()
        columns = np.concatenate([delays.steps, delays.channel])
        for column in np.unique(columns, axis=1).T:
            mask, delay = (columns == column[:, None]).all(axis=0), column[:bodies][which]
            slots, rests = self._slots(delay, delays), delay % period
            worlds_by_rest = {rest: _rows(rests == rest) for rest in np.unique(rests).tolist()}
            ring = torch.zeros((int(slots.max()), len(body), int(mask.sum())), dtype=dtype, device=body.device)
            channel = put(column[bodies:][which])
            self._parts.append(Part(_rows(mask), put(slots), worlds_by_rest, ring, put(delay), channel))
        self.arrived = torch.zeros((len(body), columns.shape[1]), dtype=dtype, device=body.device)
        """What has arrived, shape (worlds, n)."""
        self.deviations = torch.zeros((len(body), 0), dtype=torch.int64, device=body.device)
        """By how many physics steps delays are longer now, shape (worlds, channels); none if they do not vary."""

    def send(self, clock: torch.Tensor, values: torch.Tensor, rest: int | None = None) -> None:
        """Send values, shape (worlds, n), or those whose delay is *rest* physics steps over whole control steps."""
        for part, rows in self._due(rest):
            slots = (clock % part.slots)[rows]
            part.ring[slots, self._worlds[rows]] = values[:, part.columns][rows]

    def receive(self, clock: torch.Tensor, rest: int | None = None) -> torch.Tensor:
        """Return what has arrived, shape (worlds, n), where those numbers are new that `send` sends."""
        for part, rows in self._due(rest):
            slots = ((clock + 1) % part.slots)[rows]
            places = rows if isinstance(rows, slice) or isinstance(part.columns, slice) else rows[:, None]
            self.arrived[places, part.columns] = part.ring[slots, self._worlds[rows]]
        return self.arrived

    def advance(self, physics_steps: int) -> None:
        """Let delays vary over some physics steps; these do not."""

    def fill(self, begin: torch.Tensor, start: torch.Tensor) -> None:
        """Forget all that is on the way in worlds that begin, shape (worlds,); rows of *start* come out until then."""
        for part in self._parts:
            torch.where(begin[:, None], start[:, part.columns], part.ring, out=part.ring)

    def history(self, clock: torch.Tensor) -> torch.Tensor:
        """Return what was sent, the newest first, shape (worlds, ages, n); the oldest is repeated."""
        ages = torch.arange(max(len(part.ring) for part in self._parts), device=clock.device)[:, None]
        sent = self.arrived.new_empty((len(ages), *self.arrived.shape))
        for part in self._parts:
            slots = (self._now(clock) - torch.minimum(ages, part.slots - 1)) % part.slots
            sent[:, :, part.columns] = part.ring[slots, self._worlds]
        return sent.movedim(0, 1)

    def restore(self, clock: torch.Tensor, history: torch.Tensor) -> None:
        """Put a history on the way, shape (worlds, ages, n): the newest, and where some are missing, the oldest again.

        So signals keep their order where delays have become others, as in `mimoc.runtime.delays.schedule`.
        """
        for part in self._parts:
            slots = torch.arange(len(part.ring), device=clock.device)[:, None]
            ages = ((self._now(clock) - slots) % part.slots).clamp(max=history.shape[1] - 1)
            part.ring.copy_(history[self._worlds, ages][:, :, part.columns])

    def slot(self, clock: torch.Tensor) -> Slot:
        """Return the history of the line at a time, as a part of states."""
        return Slot(lambda: self.history(clock), lambda history: self.restore(clock, history))

    def _rests(self, steps: IntArray) -> IntArray:
        return np.unique(steps % self._period)

    def _slots(self, delay: IntArray, delays: Delays) -> IntArray:
        return delay // self._period + 1

    def _now(self, clock: torch.Tensor) -> torch.Tensor:
        """Return the time of what was sent last."""
        return clock

    def _due(self, rest: int | None) -> Iterator[tuple[Part, Rows]]:
        for part in self._parts:
            if rest is None:
                yield part, slice(None)
            elif rest in part.worlds_by_rest:
                yield part, part.worlds_by_rest[rest]


class JitteredLine(Line):
    """What is on its way of a signal whose delays vary as by `DelayRandomWalk`: sent at every physics step.

    A control step with number k is that of the physics steps k p to k p + p - 1, if p is its length: a command is sent
    at all of them, and what is sampled after the i-th at k p + i - 1.
    """

    def __init__(
        self,
        delays: Delays,
        period: int,
        body: torch.Tensor,
        uniforms: Uniforms,
        dtype: torch.dtype = torch.float32,
    ):
        """Begin with nothing on the way; what varies is drawn by *uniforms*."""
        super().__init__(delays, period, body, dtype)
        most = np.zeros((len(delays.steps), int(delays.channel.max(initial=0)) + 1), np.intp)
        np.maximum.at(most, (np.arange(len(most))[:, None], delays.channel), delays.jitter)
        self._most, self._uniforms = put(most)[body], uniforms
        self.deviations = torch.zeros_like(self._most)

    def send(self, clock: torch.Tensor, values: torch.Tensor, rest: int | None = None) -> None:
        """Send values for all of a control step, or those sampled *rest* physics steps before its end."""
        first, count = (0, self._period) if rest is None else (self._period - 1 - rest, 1)
        times = clock * self._period + first + torch.arange(count, device=clock.device)
        for part in self._parts:
            part.ring[times % len(part.ring)] = values[:, part.columns]

    def receive(self, clock: torch.Tensor, rest: int | None = None) -> torch.Tensor:
        """Return what has arrived after *rest* physics steps of a control step, shape (worlds, n), or at its end."""
        now = self._now(clock) if rest is None else clock * self._period + rest
        for part in self._parts:
            late = part.delay + self.deviations[self._worlds, part.channel]
            self.arrived[:, part.columns] = part.ring[(now - late) % len(part.ring), self._worlds]
        return self.arrived

    def advance(self, physics_steps: int) -> None:
        """Let delays vary over some physics steps, as `DelayRandomWalk.advance` does."""
        drawn = self._uniforms((*self.deviations.shape, physics_steps))
        for moves in ((3 * drawn).long() - 1).unbind(dim=-1):
            self.deviations = torch.minimum(torch.maximum(self.deviations + moves, -self._most), self._most)

    def fill(self, begin: torch.Tensor, start: torch.Tensor) -> None:
        """Forget all that is on the way in worlds that begin, whose deviations begin at any value."""
        super().fill(begin, start)
        drawn = (self._uniforms(self.deviations.shape) * (2 * self._most + 1)).long() - self._most
        self.deviations = where_worlds(begin, torch.minimum(drawn, self._most), self.deviations)

    def _rests(self, steps: IntArray) -> IntArray:
        return np.arange(self._period)

    def _slots(self, delay: IntArray, delays: Delays) -> IntArray:
        return np.full_like(delay, (delays.steps + delays.jitter).max() + self._period)

    def _now(self, clock: torch.Tensor) -> torch.Tensor:
        return clock * self._period + self._period - 1


def _rows(mask: Mask) -> Rows:
    """Return where a mask is true, as a slice if it is everywhere."""
    return slice(None) if mask.all() else put(np.flatnonzero(mask))
