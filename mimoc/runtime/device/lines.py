"""Delay lines of all infants on a device: the law of `mimoc.runtime.delays.signals` over arrays.

A signal is sent every e physics steps, and a delay line is a ring of slots for as many of these times as the longest
delay takes, and one more. The signal with the number i is in the slot i modulo their number, so that a reset only fills
all slots. Without jitter, e is the control step, and a sense is sampled before the end of a control step by the rest of
its delay, so that its samples arrive at the end of one; with jitter, it is sampled after each physics step.

With control steps of 2 physics steps and a delay of 5, whose rest is 1, there are 3 slots:

    time       0   1   2   3   4   5   6   7   8
    sampled        a       b       c       d          into the slots 0, 1, 2, 0
    observed                               a       b

The history of a line is what was sent last, by age: the newest first, each number as far back as it is still on its way
or has just arrived. It says nothing of times and slots, so that it can be kept, and put into lines with other delays.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import torch

from mimoc.runtime.delays.signals import Mask, first_deviation, next_deviation, number_arriving
from mimoc.runtime.device.arrays import put, where_worlds
from mimoc.runtime.device.states import Slot
from mimoc.runtime.sense import IntArray

Rows = torch.Tensor | slice
Uniforms = Callable[[Sequence[int]], torch.Tensor]
"""From a shape, (worlds, ...), to random numbers from 0 to less than 1."""


class Part(NamedTuple):
    """Numbers of a signal with a common delay, which depends on the infant."""

    columns: Rows
    delay: torch.Tensor  # In physics steps, shape (worlds,).
    first: torch.Tensor  # When the signal with the number 0 is sent, shape (worlds,).
    slots: torch.Tensor  # How many slots are used, shape (worlds,).
    ring: torch.Tensor  # What is on its way, shape (slots, worlds, columns).
    rows_by_rest: dict[int, Rows]  # The worlds whose delay can take some physics steps more than whole control steps.
    channel: torch.Tensor  # Which of the deviations of each world is added to its delay, shape (worlds,).


class Delays(NamedTuple):
    """The delays of the n numbers of a signal, in physics steps; shape (n,), or (bodies, n)."""

    steps: IntArray
    jitter: IntArray  # How far the delay varies at most.
    channel: IntArray
    """Numbers of one channel vary together: 0, and 1 for those in the legs where they have a delay of their own."""


class DelayLine:
    """What is on its way of one signal of all infants.

    The control step with the number c ends at the time c p, if p is its length, and samples arrive then. A command is
    sent at the time c p, from which on its own control step is counted.
    """

    def __init__(
        self,
        delays: Delays,
        period: int,
        body: torch.Tensor,
        uniforms: Uniforms,
        are_commands: bool = False,
        dtype: torch.dtype = torch.float32,
    ):
        """Begin with nothing on the way: *delays* are of each body, *body* is the one in each world, shape (worlds,).

        A control step has *period* physics steps.
        """
        self._period, self._worlds, self._uniforms = period, torch.arange(len(body), device=body.device), uniforms
        self._is_jittered = bool(delays.jitter.any())
        self._every = 1 if self._is_jittered and not are_commands else period
        self._last = period - 1 if are_commands else 0
        """When something arrives last in a control step."""
        self.rests: IntArray = np.arange(period) if self._is_jittered else np.unique(delays.steps % period)
        """By how many physics steps delays can be longer than whole control steps."""
        bodies, which = len(delays.steps), body.tolist()
        columns, self._parts = np.concatenate(delays), list[Part]()
        for column in np.unique(columns, axis=1).T:
            mask = (columns == column[:, None]).all(axis=0)
            delay, jitter, channel = column.reshape(3, bodies)[:, which]
            rest = np.zeros_like(delay) if self._is_jittered else delay % period
            slots = 1 - number_arriving(rest, delay + jitter, self._every)
            rows_by_rest: dict[int, Rows] = {int(rest): slice(None) for rest in self.rests}
            if not self._is_jittered:
                rows_by_rest = {int(other): _rows(rest == other) for other in np.unique(rest)}
            ring = torch.zeros((int(slots.max()), len(body), int(mask.sum())), dtype=dtype, device=body.device)
            arrays = (put(values) for values in (delay, 0 * rest if are_commands else -rest, slots))
            self._parts.append(Part(_rows(mask), *arrays, ring, rows_by_rest, put(channel)))
        self.arrived = torch.zeros((len(body), columns.shape[1]), dtype=dtype, device=body.device)
        """What has arrived, shape (worlds, n)."""
        most = np.zeros((bodies, int(delays.channel.max(initial=0)) + 1), np.intp)
        np.maximum.at(most, (np.arange(bodies)[:, None], delays.channel), delays.jitter)
        self._most = put(most if self._is_jittered else most[:, :0])[body]
        self.deviations = torch.zeros_like(self._most)
        """By how many physics steps delays are longer now, shape (worlds, channels); none without jitter."""

    def send(self, clock: torch.Tensor, values: torch.Tensor, rest: int | None = None) -> None:
        """Send values, shape (worlds, n), or samples *rest* physics steps before the end of a control step.

        Without jitter, those are sent whose delay has this rest.
        """
        time = clock * self._period - (rest or 0)
        for part, rows in self._due(rest):
            slots = (number_arriving(time, part.first, self._every) % part.slots)[rows]
            part.ring[slots, self._worlds[rows]] = values[:, part.columns][rows]

    def receive(self, clock: torch.Tensor, rest: int | None = None) -> torch.Tensor:
        """Return what has arrived, shape (worlds, n), at the end of a control step, or of commands after *rest*.

        Without jitter, those arrive after some physics steps whose delay has this rest.
        """
        time = clock * self._period + (rest or 0)
        for part, rows in self._due(rest):
            slots = (number_arriving(time, self._late(part), self._every) % part.slots)[rows]
            places = rows if isinstance(rows, slice) or isinstance(part.columns, slice) else rows[:, None]
            self.arrived[places, part.columns] = part.ring[slots, self._worlds[rows]]
        return self.arrived

    def advance(self, physics_steps: int) -> None:
        """Let delays vary over some physics steps."""
        if self._is_jittered:
            for drawn in self._uniforms((*self.deviations.shape, physics_steps)).unbind(dim=-1):
                self.deviations = next_deviation(self.deviations, self._most, drawn, torch.Tensor.long)

    def deviate(self, deviations: torch.Tensor) -> None:
        """Let delays be longer by some physics steps, shape (worlds, channels), or by as many as they can be."""
        self.deviations = torch.minimum(torch.maximum(deviations, -self._most), self._most)

    def fill(self, begin: torch.Tensor, start: torch.Tensor) -> None:
        """Forget all that is on the way in worlds that begin, shape (worlds,); rows of *start* come out until then."""
        for part in self._parts:
            torch.where(begin[:, None], start[:, part.columns], part.ring, out=part.ring)
        if self._is_jittered:
            drawn = first_deviation(self._most, self._uniforms(self.deviations.shape), torch.Tensor.long)
            self.deviations = where_worlds(begin, drawn, self.deviations)

    def history(self, clock: torch.Tensor) -> torch.Tensor:
        """Return what was sent, the newest first, shape (worlds, ages, n); the oldest is repeated."""
        ages = torch.arange(max(len(part.ring) for part in self._parts), device=clock.device)[:, None]
        sent = self.arrived.new_empty((len(ages), *self.arrived.shape))
        for part in self._parts:
            newest = self._newest(part, clock)
            arrived = number_arriving(clock * self._period + self._last, self._late(part), self._every)
            slots = torch.maximum(newest - ages, arrived) % part.slots
            sent[:, :, part.columns] = part.ring[slots, self._worlds]
        return sent.movedim(0, 1)

    def restore(self, clock: torch.Tensor, history: torch.Tensor) -> None:
        """Put a history on the way, shape (worlds, ages, n): the newest, and where some are missing, the oldest again.

        So signals keep their order where delays have become others, as those of the CPU do.
        """
        for part in self._parts:
            slots = torch.arange(len(part.ring), device=clock.device)[:, None]
            ages = ((self._newest(part, clock) - slots) % part.slots).clamp(max=history.shape[1] - 1)
            part.ring.copy_(history[self._worlds, ages][:, :, part.columns])

    def slot(self, clock: torch.Tensor) -> Slot:
        """Return the history of the line at a time, as a part of states."""
        return Slot(lambda: self.history(clock), lambda history: self.restore(clock, history))

    def _late(self, part: Part) -> torch.Tensor:
        """Return by how much later the signals arrive now than the time that their numbers are counted from."""
        late = part.delay + part.first
        return late + self.deviations[self._worlds, part.channel] if self._is_jittered else late

    def _newest(self, part: Part, clock: torch.Tensor) -> torch.Tensor:
        """Return the number of what was sent last by the end of a control step."""
        return number_arriving(clock * self._period + self._last, part.first, self._every)

    def _due(self, rest: int | None) -> Iterator[tuple[Part, Rows]]:
        for part in self._parts:
            if rest is None:
                yield part, slice(None)
            elif rest in part.rows_by_rest:
                yield part, part.rows_by_rest[rest]


def _rows(mask: Mask) -> Rows:
    return slice(None) if mask.all() else put(np.flatnonzero(mask))
