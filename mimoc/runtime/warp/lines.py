"""Delay lines on a device: what is sampled or commanded now arrives later, for each number and infant after its delay.

A line is a ring of slots, one for each control step that the longest delay of any infant takes and one more: whatever
was sent L steps ago is in slot (clock - L) modulo (L + 1). So a reset only fills all slots.
"""

from typing import Any

import numpy as np
import warp as wp

from mimoc.bundle.manifest import Manifest
from mimoc.delays.signals import Mask
from mimoc.delays.spec import DelayEntry
from mimoc.runtime.warp.arrays import put
from mimoc.senses.sense import IntArray
from mimoc.units import to_steps

DTYPES = (wp.float32, wp.uint8)
"""What numbers a signal can have: of most senses and of commands, and of pictures."""


def delay_steps(manifest: Manifest, signal: str, in_legs: Mask | None, count: int) -> IntArray:
    """Return the delay of each of some numbers of a signal, in physics steps, shape (count,).

    Args:
        manifest: Of the infant.
        signal: The signal.
        in_legs: Which of the numbers belong to the legs, shape (count,); None where none does.
        count: How many numbers there are.
    """
    entry: DelayEntry = getattr(manifest.delays, signal, DelayEntry())
    steps = np.full(count, to_steps(entry.ms, manifest.timestep_ms))
    if entry.legs_ms is not None and in_legs is not None:
        steps[in_legs] = to_steps(entry.legs_ms, manifest.timestep_ms)
    return steps


class Ring:
    """What is on its way of one signal of all infants."""

    def __init__(self, delays: IntArray, period: int, body_of_world: wp.array, numbers: int, dtype: Any):
        """Begin with nothing on the way.

        Args:
            delays: In physics steps, shape (bodies, n), or (bodies, 1) if all numbers of a body have the same delay.
            period: Physics steps in a control step.
            body_of_world: Which body lives in each world, shape (worlds,).
            numbers: How many numbers of an infant there are, n.
            dtype: Of the numbers, one of `DTYPES`.
        """
        self.delays, self._body, worlds = delays, body_of_world, body_of_world.shape[0]
        self._length, self._rest = put(delays // period, wp.int32), put(delays % period, wp.int32)
        self._ring = wp.zeros((int((delays // period).max(initial=0)) + 1, worlds, numbers), dtype=dtype)
        self.entering = wp.zeros((worlds, numbers), dtype=dtype)
        """What is sampled or commanded now, shape (worlds, n)."""

    def send(self, clock: wp.array, rest: int) -> None:
        """Send those numbers whose delay is *rest* steps more than whole control steps; -1 is all of them."""
        inputs = [clock, self._body, self._length, self._rest, rest, self.entering]
        wp.launch(_send, self.entering.shape, inputs, [self._ring])

    def refill(self, start: wp.array, table: wp.array) -> None:
        """Forget all that is on the way in worlds that start anew; their rows of a table come out until then."""
        wp.launch(_refill, self._ring.shape, [start, table], [self._ring])


class Line(Ring):
    """The numbers of a sense or the commands of all infants on their way."""

    def __init__(self, delays: IntArray, period: int, body_of_world: wp.array):
        """Begin with nothing on the way; see `Ring`, with a delay for each number."""
        super().__init__(delays, period, body_of_world, delays.shape[1], wp.float32)

    def arrive(self, clock: wp.array, low: wp.array, high: wp.array, arrived: wp.array) -> None:
        """Write what has arrived, within bounds of shape (bodies, n), to an array of shape (worlds, n)."""
        wp.launch(_arrive, arrived.shape, [clock, self._body, self._length, low, high, self._ring], [arrived])

    def apply(self, clock: wp.array, rest: int, columns: wp.array, values: wp.array) -> None:
        """Write the commands that arrive *rest* physics steps into a control step to columns of an array."""
        inputs = [clock, self._body, self._length, self._rest, rest, columns, self._ring]
        wp.launch(_apply, self.entering.shape, inputs, [values])


@wp.kernel(enable_backward=False)
def _send(
    clock: wp.array[int],
    body: wp.array[int],
    length: wp.array2d[int],
    rests: wp.array2d[int],
    rest: int,
    entering: wp.array2d[Any],
    ring: wp.array3d[Any],
):
    world, number = wp.tid()
    mine, delay = body[world], wp.min(number, length.shape[1] - 1)
    if rest < 0 or rests[mine, delay] == rest:
        ring[clock[0] % (length[mine, delay] + 1), world, number] = entering[world, number]


@wp.kernel(enable_backward=False)
def _arrive(
    clock: wp.array[int],
    body: wp.array[int],
    length: wp.array2d[int],
    low: wp.array2d[float],
    high: wp.array2d[float],
    ring: wp.array3d[float],
    arrived: wp.array2d[float],
):
    world, number = wp.tid()
    mine = body[world]
    value = ring[(clock[0] + 1) % (length[mine, number] + 1), world, number]
    if wp.isnan(value):
        value = 0.0
    arrived[world, number] = wp.clamp(value, low[mine, number], high[mine, number])


@wp.kernel(enable_backward=False)
def _apply(
    clock: wp.array[int],
    body: wp.array[int],
    length: wp.array2d[int],
    rests: wp.array2d[int],
    rest: int,
    columns: wp.array[int],
    ring: wp.array3d[float],
    values: wp.array2d[float],
):
    world, number = wp.tid()
    mine = body[world]
    if rests[mine, number] == rest:
        values[world, columns[number]] = ring[(clock[0] + 1) % (length[mine, number] + 1), world, number]


@wp.kernel(enable_backward=False)
def _refill(start: wp.array[int], table: wp.array2d[Any], ring: wp.array3d[Any]):
    slot, world, number = wp.tid()
    if start[world] >= 0:
        ring[slot, world, number] = table[start[world], number]


for _dtype in DTYPES:  # All at once, for each that came later would compile this module again.
    wp.overload(_send, {"entering": wp.array2d[_dtype], "ring": wp.array3d[_dtype]})
    wp.overload(_refill, {"table": wp.array2d[_dtype], "ring": wp.array3d[_dtype]})
