"""The delay line of pictures on a device: as `Line`, in 8 bits, with one delay for all that an infant sees."""

from collections.abc import Sequence

import warp as wp

from mimoc.runtime.warp.arrays import put
from mimoc.senses.sense import IntArray


class PictureLine:
    """The pictures of all infants on their way."""

    def __init__(self, delays: IntArray, period: int, body_of_world: wp.array, numbers: int):
        """Begin with nothing on the way.

        Args:
            delays: In physics steps, shape (bodies,).
            period: Physics steps in a control step.
            body_of_world: Which body lives in each world, shape (worlds,).
            numbers: How many numbers an infant sees.
        """
        self.delays, self._body, worlds = delays, body_of_world, body_of_world.shape[0]
        self._length, self._rest = put(delays // period, wp.int32), put(delays % period, wp.int32)
        self._ring = wp.zeros((int((delays // period).max()) + 1, worlds, numbers), dtype=wp.uint8)
        self.entering = wp.zeros((worlds, numbers), dtype=wp.uint8)
        """What is seen now, shape (worlds, n)."""

    def send(self, clock: wp.array, rest: int) -> None:
        """Send what those see whose delay is *rest* steps more than whole control steps."""
        inputs = [clock, self._body, self._length, self._rest, rest, self.entering]
        wp.launch(_send, self.entering.shape, inputs, [self._ring])

    def arrive(self, clock: wp.array, pictures: Sequence[wp.array]) -> None:
        """Write what has arrived to an array of each eye, shape (worlds, height, width, 3)."""
        first = 0
        for picture in pictures:
            rows = picture.reshape((picture.shape[0], picture.size // picture.shape[0]))
            wp.launch(_arrive, rows.shape, [clock, self._body, self._length, first, self._ring], [rows])
            first += rows.shape[1]

    def refill(self, start: wp.array, table: wp.array) -> None:
        """Forget all that is on the way in worlds that start anew; their rows of a table are seen until then."""
        wp.launch(_refill, self._ring.shape, [start, table], [self._ring])


@wp.kernel(enable_backward=False)
def _send(
    clock: wp.array[int],
    body: wp.array[int],
    length: wp.array[int],
    rests: wp.array[int],
    rest: int,
    entering: wp.array2d[wp.uint8],
    ring: wp.array3d[wp.uint8],
):
    world, number = wp.tid()
    mine = body[world]
    if rests[mine] == rest:
        ring[clock[0] % (length[mine] + 1), world, number] = entering[world, number]


@wp.kernel(enable_backward=False)
def _arrive(
    clock: wp.array[int],
    body: wp.array[int],
    length: wp.array[int],
    first: int,
    ring: wp.array3d[wp.uint8],
    picture: wp.array2d[wp.uint8],
):
    world, number = wp.tid()
    picture[world, number] = ring[(clock[0] + 1) % (length[body[world]] + 1), world, first + number]


@wp.kernel(enable_backward=False)
def _refill(start: wp.array[int], table: wp.array2d[wp.uint8], ring: wp.array3d[wp.uint8]):
    slot, world, number = wp.tid()
    if start[world] >= 0:
        ring[slot, world, number] = table[start[world], number]
