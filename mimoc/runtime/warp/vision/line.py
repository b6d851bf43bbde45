"""The delay line of pictures on a device, in 8 bits, with one delay for all that an infant sees."""

from collections.abc import Sequence

import warp as wp

from mimoc.runtime.warp.lines import Ring
from mimoc.senses.sense import IntArray


class PictureLine(Ring):
    """The pictures of all infants on their way."""

    def __init__(self, delays: IntArray, period: int, body_of_world: wp.array, numbers: int):
        """Begin with nothing on the way; see `Ring`, with delays of shape (bodies, 1)."""
        super().__init__(delays, period, body_of_world, numbers, wp.uint8)

    def arrive(self, clock: wp.array, pictures: Sequence[wp.array]) -> None:
        """Write what has arrived to an array of each eye, shape (worlds, height, width, 3)."""
        first = 0
        for picture in pictures:
            rows = picture.reshape((picture.shape[0], picture.size // picture.shape[0]))
            wp.launch(_arrive, rows.shape, [clock, self._body, self._length, first, self._ring], [rows])
            first += rows.shape[1]


@wp.kernel(enable_backward=False)
def _arrive(
    clock: wp.array[int],
    body: wp.array[int],
    length: wp.array2d[int],
    first: int,
    ring: wp.array3d[wp.uint8],
    picture: wp.array2d[wp.uint8],
):
    world, number = wp.tid()
    picture[world, number] = ring[(clock[0] + 1) % (length[body[world], 0] + 1), world, first + number]
