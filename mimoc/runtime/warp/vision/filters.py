"""Acuity and foveation on a device: the same pass over pictures as on the CPU, by the same numbers."""

from collections.abc import Sequence

import numpy as np
import warp as wp

from mimoc.runtime.warp.arrays import put
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.senses.vision.blur import contrast_gain
from mimoc.senses.vision.foveation import source_weights
from mimoc.senses.vision.spec import VisionEntry

Weights = tuple[IntArray, IntArray, FloatArray]
"""Where the sources of each pixel begin, shape (pixels + 1,); which pixels they are; and their shares."""


class Filters:
    """From what eyes draw to what infants see, each with its own acuity and foveation."""

    def __init__(self, entries: Sequence[VisionEntry], fovy_deg: Sequence[float], body: wp.array):
        """Work out all that depends on sizes and ages.

        Args:
            entries: Of the different bodies; sizes and cameras are the same for all.
            fovy_deg: Vertical field of view of each.
            body: Which body lives in each world, shape (worlds,).
        """
        self._body, first = body, entries[0]
        drawn = first.height_px * first.supersample, first.width_px * first.supersample
        planes = body.shape[0] * len(first.cameras) * len("rgb")
        self._planes, self._other = wp.zeros((planes, *drawn), dtype=float), None
        if any(entry.acuity_cpd is not None for entry in entries):
            self._other = wp.zeros_like(self._planes)
            self._down, self._across = (cosines(size_px) for size_px in drawn)
            gains = [_gain(entry, fovy) for entry, fovy in zip(entries, fovy_deg, strict=True)]
            self._matrices = [put(each) for each in (self._across.T, self._down, self._down.T, self._across)]
            self._gains = put(np.stack(gains))
        self._put_weights(entries)

    def __call__(self, drawn: wp.array, seen: wp.array) -> None:
        """Write what is seen.

        Args:
            drawn: What `Eyes` returns.
            seen: Rounded colours of one eye after the other, by row, column and colour, shape (worlds, n), 8 bits.
        """
        planes, height, width = self._planes.shape
        wp.launch(_unpack, (drawn.shape[0], drawn.shape[1]), [drawn, width], [self._planes])
        if self._other is not None:
            across, down, back_down, back_across = self._matrices
            wp.launch(_times, self._planes.shape, [self._planes, across], [self._other])
            wp.launch(_matrix_times, self._planes.shape, [down, self._other], [self._planes])
            per_world = planes // self._body.shape[0]
            wp.launch(_weigh, self._planes.shape, [self._body, self._gains, per_world], [self._planes])
            wp.launch(_matrix_times, self._planes.shape, [back_down, self._planes], [self._other])
            wp.launch(_times, self._planes.shape, [self._other, back_across], [self._planes])
        pictures = self._planes.reshape((planes, height * width))
        inputs = [pictures, self._body, self._table, *self._weights]
        wp.launch(_gather, (seen.shape[0], seen.shape[1] // len("rgb")), inputs, [seen])

    def _put_weights(self, entries: Sequence[VisionEntry]) -> None:
        """Put the sources of all pixels on the device, once for all bodies that have the same."""
        kinds = [(entry.foveation, entry.foveation_radius) for entry in entries]
        tables = {kind: _weights(entry) for kind, entry in zip(kinds, entries, strict=True)}
        starts, sources, shares = zip(*tables.values(), strict=True)
        before = np.cumsum([0, *map(len, sources)])[:-1]
        begun = np.stack([own + first for own, first in zip(starts, before, strict=True)])
        places = list(tables)
        self._table = put([places.index(kind) for kind in kinds], wp.int32)
        self._weights = [put(begun, wp.int32), put(np.concatenate(sources), wp.int32), put(np.concatenate(shares))]


def cosines(size: int) -> FloatArray:
    """Return the matrix of the cosine transform, shape (frequencies, points), whose transpose is its inverse."""
    frequencies, points = np.arange(size)[:, None], np.arange(size) + 0.5
    rows = np.cos(np.pi * frequencies * points / size) * np.sqrt(2 / size)
    rows[0] /= np.sqrt(2)
    return rows


def _gain(entry: VisionEntry, fovy_deg: float) -> FloatArray:
    """Return how much contrast is left of each cosine, all of it where acuity is not limited."""
    width, height = entry.width_px * entry.supersample, entry.height_px * entry.supersample
    if entry.acuity_cpd is None:
        return np.ones((height, width))
    return contrast_gain(width, height, fovy_deg, entry.acuity_cpd).astype(float)


def _weights(entry: VisionEntry) -> Weights:
    """Return what each pixel that is seen averages of the picture as it was drawn."""
    pixels, times = entry.width_px * entry.height_px, entry.supersample
    starts, sources, shares = np.arange(pixels + 1), np.arange(pixels), np.ones(pixels)
    if entry.foveation:
        found = source_weights(entry.width_px, entry.height_px, entry.foveation, entry.foveation_radius)
        starts, sources, shares = found.indptr, found.indices, found.data
    row, column = (times * each for each in np.divmod(sources, entry.width_px))
    parts = np.arange(times)
    finer = (row[:, None, None] + parts[:, None]) * (times * entry.width_px) + column[:, None, None] + parts
    return starts * times**2, finer.ravel(), np.repeat(shares / times**2, times**2)


@wp.kernel(enable_backward=False)
def _unpack(drawn: wp.array2d[wp.uint32], width: int, planes: wp.array3d[float]):
    world, pixel = wp.tid()
    size = planes.shape[1] * width
    plane = 3 * (world * (drawn.shape[1] // size) + pixel // size)
    row = (pixel % size) // width
    column = pixel % width
    packed = drawn[world, pixel]
    planes[plane, row, column] = float((packed >> wp.uint32(16)) & wp.uint32(255))
    planes[plane + 1, row, column] = float((packed >> wp.uint32(8)) & wp.uint32(255))
    planes[plane + 2, row, column] = float(packed & wp.uint32(255))


@wp.kernel(enable_backward=False)
def _times(pictures: wp.array3d[float], matrix: wp.array2d[float], products: wp.array3d[float]):
    plane, row, column = wp.tid()
    total = float(0.0)
    for index in range(matrix.shape[0]):
        total += pictures[plane, row, index] * matrix[index, column]
    products[plane, row, column] = total


@wp.kernel(enable_backward=False)
def _matrix_times(matrix: wp.array2d[float], pictures: wp.array3d[float], products: wp.array3d[float]):
    plane, row, column = wp.tid()
    total = float(0.0)
    for index in range(matrix.shape[1]):
        total += matrix[row, index] * pictures[plane, index, column]
    products[plane, row, column] = total


@wp.kernel(enable_backward=False)
def _weigh(body: wp.array[int], gains: wp.array3d[float], planes_per_world: int, planes: wp.array3d[float]):
    plane, row, column = wp.tid()
    planes[plane, row, column] = planes[plane, row, column] * gains[body[plane // planes_per_world], row, column]


@wp.kernel(enable_backward=False)
def _gather(
    pictures: wp.array2d[float],
    body: wp.array[int],
    table: wp.array[int],
    starts: wp.array2d[int],
    sources: wp.array[int],
    shares: wp.array[float],
    seen: wp.array2d[wp.uint8],
):
    world, number = wp.tid()
    pixels = starts.shape[1] - 1
    eye, pixel = number // pixels, number % pixels
    plane = 3 * (world * (seen.shape[1] // (3 * pixels)) + eye)
    own = table[body[world]]
    colour = wp.vec3(0.0, 0.0, 0.0)
    for entry in range(starts[own, pixel], starts[own, pixel + 1]):
        at, share = sources[entry], shares[entry]
        colour += share * wp.vec3(pictures[plane, at], pictures[plane + 1, at], pictures[plane + 2, at])
    for part in range(3):
        seen[world, 3 * number + part] = wp.uint8(wp.rint(wp.clamp(colour[part], 0.0, 255.0)))
