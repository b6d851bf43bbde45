"""Foveation: warping a picture so that its centre has a finer resolution than its rim, and blur by visual acuity."""

import functools
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import fft, sparse

from mimoc.base.geometry.foveation import RADII, to_source
from mimoc.schema.quantities import Direction

Pictures = npt.NDArray[np.float32]  # Shape (..., height, width, colours), 0 to 255.
FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

SIDE_PARTS = 4  # Straight parts that stand for each side of a pixel, which the warp bends.
CELLS_AT_ONCE = 4096
"""Pixels whose sources are looked up in one go: as much as keeps the arrays within some ten megabytes."""


def foveate(pictures: Pictures, sources: sparse.csr_array) -> Pictures:
    """Return warped pictures, of the size for which `source_weights` returned their sources."""
    *others, height, width, colours = pictures.shape
    flat = pictures.reshape(-1, height * width, colours)
    return np.stack([sources @ picture for picture in flat]).reshape(*others, height, width, colours)


@functools.lru_cache(maxsize=32)
def source_weights(width_px: int, height_px: int, strength: float, radius: str) -> sparse.csr_array:
    """Return what each pixel of a warped picture averages of the picture as it was drawn, shape (pixels, pixels).

    A pixel's weights are the areas of its preimage within the pixels drawn, as shares of all of it; the rows of pixels
    that have no source, which stay black, are empty. Pixels count along the rows, from the top left. For *strength*,
    above 0, and *radius*, see `to_source`.
    """
    size_px, pixels = (width_px, height_px), width_px * height_px
    shown = np.flatnonzero(RADII[radius](_corners(np.arange(pixels), size_px) + 0.5, size_px) <= 1)
    parts = []
    for start in range(0, len(shown), CELLS_AT_ONCE):
        cells = shown[start : start + CELLS_AT_ONCE]
        outlines_px = to_source(_outlines(cells, size_px), size_px, strength, radius)
        owners, sources = _overlapping(outlines_px, size_px)
        areas_px2 = _areas_within(outlines_px[owners] - _corners(sources, size_px)[:, None])
        parts.append((areas_px2, cells[owners], sources))
    areas_px2, cells, sources = map(np.concatenate, zip(*parts, strict=True))
    weights = areas_px2 / np.bincount(cells, areas_px2, pixels)[cells]
    kept = weights > 0
    placed = (weights[kept].astype(np.float32), (cells[kept].astype(np.int32), sources[kept].astype(np.int32)))
    return sparse.coo_array(placed, shape=(pixels, pixels)).tocsr()


def _corners(cells: IntArray, size_px: tuple[int, int]) -> FloatArray:
    """Return the top left corner of pixels, x and y from the centre of the picture, shape (n, 2)."""
    rows, columns = np.divmod(cells, size_px[0])
    return np.stack([columns, rows], axis=-1) - np.divide(size_px, 2)


def _outlines(cells: IntArray, size_px: tuple[int, int]) -> FloatArray:
    """Return points around pixels, shape (n, 4 `SIDE_PARTS`, 2)."""
    along = np.arange(SIDE_PARTS) / SIDE_PARTS
    ahead, back = np.ones(SIDE_PARTS), 1 - along
    x = np.concatenate([along, ahead, back, 0 * ahead])
    y = np.concatenate([0 * ahead, along, ahead, back])
    return _corners(cells, size_px)[:, None] + np.stack([x, y], axis=-1)


def _overlapping(outlines_px: FloatArray, size_px: tuple[int, int]) -> tuple[IntArray, IntArray]:
    """Return pairs of an outline and a pixel of the picture in the box around it, as two arrays of shape (n,)."""
    width = size_px[0]
    first = np.floor(outlines_px.min(axis=1) + np.divide(size_px, 2)).astype(int).clip(0)
    last = np.ceil(outlines_px.max(axis=1) + np.divide(size_px, 2)).astype(int).clip(max=size_px)
    columns, rows = (last - first).T
    counts = columns * rows
    owners = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    row, column = np.divmod(within, columns[owners])
    return owners, (first[owners, 1] + row) * width + first[owners, 0] + column


def _areas_within(outlines: FloatArray) -> FloatArray:
    """Return the area that each outline has in common with the square from 0 to 1, shape (n,).

    By Green's theorem: around the outline, shape (n, points, 2), the integral of y over x, with x and y kept within the
    square.
    """
    x, y = outlines[..., 0], outlines[..., 1]
    next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    slope = np.divide(next_y - y, next_x - x, out=np.zeros_like(x), where=next_x != x)
    inner_x, inner_next_x = x.clip(0, 1), next_x.clip(0, 1)
    inner_y, inner_next_y = y + (inner_x - x) * slope, y + (inner_next_x - x) * slope
    integrals = (inner_next_x - inner_x) * _mean_clipped(inner_y, inner_next_y)
    return np.abs(integrals.sum(axis=1))


def _mean_clipped(start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the mean of the numbers from one to another, each clipped to the range from 0 to 1."""
    middle, step = (start + end) / 2, end - start
    is_long = np.abs(step) > 1e-6
    return np.divide(_summed_clipped(end) - _summed_clipped(start), step, out=middle.clip(0, 1), where=is_long)


def _summed_clipped(number: FloatArray) -> FloatArray:
    """Return the integral of `clip(x, 0, 1)` over x up to a number."""
    inner = number.clip(0, 1)
    return inner**2 / 2 + np.maximum(number - 1, 0)


ROWS_AND_COLUMNS = (-3, -2)


def blur(pictures: Pictures, gain: Pictures) -> Pictures:
    """Return pictures through an eye's contrast sensitivity, which `contrast_gain` returns; they are not clipped.

    A cosine transform continues a picture beyond each border as its mirror image, so no border leaks into the opposite
    one, and the mean stays the same.
    """
    spectrum = np.asarray(fft.dctn(pictures, axes=ROWS_AND_COLUMNS))
    spectrum *= gain[..., None]
    return np.asarray(fft.idctn(spectrum, axes=ROWS_AND_COLUMNS, overwrite_x=True))


@functools.lru_cache(maxsize=32)
def contrast_gain(width_px: int, height_px: int, fovy_deg: float, acuity_cpd: float, law: str = "linear") -> Pictures:
    """Return how much contrast is left of each cosine of a picture, shape (height, width), 1 for its mean; read-only.

    It is what one of `CONTRAST_LAWS` says of its cycles per degree, as degrees are at the centre.
    """
    return read_only(CONTRAST_LAWS[law](cosine_frequencies_cpd(width_px, height_px, fovy_deg), acuity_cpd))


def cosine_frequencies_cpd(width_px: int, height_px: int, fovy_deg: float) -> FloatArray:
    """Return the frequency of each cosine of a picture at its centre, in cycles per degree, shape (height, width)."""
    rows, columns = (np.arange(size_px) / (2 * size_px) for size_px in (height_px, width_px))
    return np.hypot(rows[:, None], columns) * pixels_per_degree(height_px, fovy_deg)


def read_only(values: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return numbers with 32 bits, to be kept and shared."""
    array = values.astype(np.float32)
    array.flags.writeable = False
    return array


def visual_field(width_px: int, height_px: int, fovy_deg: float, field_deg: Mapping[Direction, float]) -> Pictures:
    """Return 1 where an eye sees and 0 where it does not, shape (height, width).

    *field_deg* is how far it sees `left`, `right`, `up` and `down` of its line of sight, in the picture's plane.
    """
    across, down = pixel_tangents(width_px, height_px, fovy_deg)
    tangents = {side: math.tan(math.radians(min(angle_deg, MAX_DEG))) for side, angle_deg in field_deg.items()}
    left, right, up, low = (tangents.get(side, math.inf) for side in ("left", "right", "up", "down"))
    columns, rows = (across >= -left) & (across <= right), (down >= -up) & (down <= low)
    return (rows[:, None] & columns).astype(np.float32)


MAX_DEG = 89.9  # Beyond this no plane picture reaches.


def pixel_tangents(width_px: int, height_px: int, fovy_deg: float) -> list[FloatArray]:
    """Return the tangents of the angles to the middles of pixels, from left to right and from the top down."""
    tangent = 2 * math.tan(math.radians(fovy_deg) / 2) / height_px
    return [(np.arange(size, dtype=np.float64) + 0.5 - size / 2) * tangent for size in (width_px, height_px)]


def _power_law(frequencies_cpd: FloatArray, acuity_cpd: float) -> FloatArray:
    """Return MIMo3's contrast: all of it below .1 cycles per degree, then (10 f)^b with b such that .01 is left at a.

    Acuities are at least twice that frequency, as they are at any age.
    """
    exponent = -2 / np.log10(10 * max(acuity_cpd, 0.2))
    left = (10 * np.maximum(frequencies_cpd, 0.1)) ** exponent
    return np.where(frequencies_cpd < 0.1, 1.0, left.clip(0.01, 0.99))


CONTRAST_LAWS: Mapping[str, Callable[[FloatArray, float], FloatArray]] = {
    "linear": lambda frequencies_cpd, acuity_cpd: np.maximum(0.0, 1 - frequencies_cpd / acuity_cpd),
    "mimo3": _power_law,
}
"""Contrast that is left at some frequencies by acuity, both in cycles per degree: max(0, 1 - f / a) of López et al.
2025 (equation 2), or the law of MIMo3's code."""


def pixels_per_degree(height_px: int, fovy_deg: float) -> float:
    """Return how many pixels of a pinhole camera's picture a degree takes at its centre."""
    focal_length_px = height_px / (2 * np.tan(np.radians(fovy_deg) / 2))
    return float(np.radians(focal_length_px))
