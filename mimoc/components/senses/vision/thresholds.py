"""Contrast thresholds: of a picture's luminance, what an eye's contrast sensitivity lets through at each frequency.

A picture is the sum of bands of 1.5 octaves, with weights w(f) that are cosines of log f (Peli 1990, J Opt Soc Am A 7:
2032). The contrast sensitivity S(f) weights each band such that a grating that is just seen has the amplitude of the
mean luminance m there, wherever between the middles of two bands its frequency is:

    A = what w g S leaves of the picture, with g(f) = 1 / max w(f)
    B = what w (1 - f / a) leaves of it, with the acuity a
    seen = sum of B sqrt(1 - m² / A²) over the bands, where |A| > m

So a contrast c at one frequency is lost below 1 / S, and of more than that is left what acuity leaves, but for
1 / (c S²): what is well above the threshold looks as if there was none (Georgeson & Sullivan 1975). The mean of a
picture stays. Contrast is that to the mean of the whole picture, and brightness counts as if it were luminance.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import fft

from mimoc.components.senses.vision import CSF_EXPONENT
from mimoc.components.senses.vision.foveation import FloatArray, pixels_per_degree, read_only

Planes = npt.NDArray[np.float32]  # Shape (..., height, width).

MIN_CPD = 0.1  # Below the lowest frequency that infants were tested with, sensitivity is as there.
OCTAVES = 1.5
"""Distance of the middles of two bands, and their width at half of their height: as channels of adults, 1 to 2."""
MIN_HALF_CYCLES = 4
"""Fewest half cycles across the picture's shorter side at the middle of the lowest band; what is slower has no
threshold."""
GRID_PX, SPARE = 4, 1.5
"""Bands are worked out in pictures that have a multiple of so many pixels either way, and so many for each cosine, as
the peaks of gratings lie between pixels where these are few."""
TINY = 1e-6  # Added to squares of levels that something is divided by.
PRODUCT_PX = 64  # Up to this size, cosine transforms are faster as products of matrices.


@dataclass(frozen=True, slots=True)
class Transform:
    """The cosine transform of planes, and its inverse, both orthonormal, in some array library."""

    forward: Callable[[Any], Any]
    inverse: Callable[[Any], Any]
    xp: Any


@dataclass(frozen=True, slots=True)
class Bands:
    """What the luminance of a picture is taken apart into."""

    rest: Any  # Weights of cosines without threshold, shape (..., height, width).
    bands: tuple[Any, ...]
    """Weights of A and B of each band, from the finest to the coarsest, shape (..., 2, rows, columns)."""

    def mapped(self, change: Callable[[Any], Any]) -> "Bands":
        """Return these with all arrays changed."""
        return Bands(change(self.rest), tuple(map(change, self.bands)))


def above_threshold(luminance: Any, bands: Bands, transform: Transform) -> Any:
    """Return what of a luminance, shape (..., height, width), is above the threshold; its mean stays the same."""
    height, width = luminance.shape[-2:]
    spectrum, fine = transform.forward(luminance), 0.0
    squared = (spectrum[..., :1, :1] / math.sqrt(height * width)) ** 2
    total = spectrum * bands.rest
    for weights in bands.bands:
        rows, columns = weights.shape[-2:]
        values = transform.inverse(spectrum[..., None, :rows, :columns] * weights)
        weighted, seen = values[..., 0, :, :], values[..., 1, :, :]
        weighted *= weighted
        weighted += TINY
        seen *= transform.xp.sqrt((1 - squared / weighted).clip(0))
        if (rows, columns) == (height, width):
            fine = fine + seen
        else:
            total[..., :rows, :columns] += transform.forward(seen) * math.sqrt(height * width / (rows * columns))
    total[..., :1, :1] = spectrum[..., :1, :1] - _total(fine) / math.sqrt(height * width)
    return transform.inverse(total) + fine


def _total(planes: Any) -> Any:
    return planes.reshape(*planes.shape[:-2], -1).sum(-1)[..., None, None]


def sensitivity_at(frequencies_cpd: FloatArray, peak: float, peak_cpd: float) -> FloatArray:
    """Return the contrast sensitivity at some frequencies: S (x e^(1-x))^.82, with x = f / peak_cpd.

    The template is derived; that one template fits all ages is Movshon & Kiorpes' (1988, J Opt Soc Am A 5).

    Example:
        >>> import numpy as np
        >>> from mimoc.components.senses.vision.thresholds import sensitivity_at
        >>> sensitivity_at(np.array([4.0, 40.0]), 250.0, 4.0).round(1).tolist()
        [250.0, 1.0]
    """
    ratio = np.maximum(frequencies_cpd, MIN_CPD) / peak_cpd
    return peak * np.exp(CSF_EXPONENT * (np.log(ratio) + 1 - ratio))


@functools.lru_cache(maxsize=32)
def threshold_bands(
    size_px: tuple[int, int], fovy_deg: float, peak: float, peak_cpd: float, acuity_cpd: float | None
) -> Bands:
    """Return the bands of pictures for an eye; all arrays are read-only.

    *peak* is the largest contrast sensitivity, at *peak_cpd*. Without *acuity_cpd*, the finest grating that is seen,
    the only limit is that of sensitivity.
    """
    width, height = size_px
    along = [np.arange(size) / (2 * size) * pixels_per_degree(height, fovy_deg) for size in (height, width)]
    frequencies_cpd = np.hypot(along[0][:, None], along[1])
    half_cycles = frequencies_cpd / pixels_per_degree(height, fovy_deg) * 2 * min(size_px)
    first = np.log2(min(size_px)) - 0.5
    count = max(1, int((first - np.log2(MIN_HALF_CYCLES)) / OCTAVES) + 1)
    steps = (np.log2(np.maximum(half_cycles, 1e-9)) - first) / OCTAVES
    weights = [_weight(steps + number) for number in range(count)]
    weights[0][steps > 0] = 1.0
    sensitivity = sensitivity_at(frequencies_cpd, peak, peak_cpd) / np.maximum(np.max(weights, axis=0), 0.5)
    left = np.ones_like(sensitivity) if acuity_cpd is None else (1 - frequencies_cpd / acuity_cpd).clip(0)
    pairs = []
    for weight in weights:
        rows, columns = (_grid_size(reach) for reach in (weight.max(axis=1) > 0, weight.max(axis=0) > 0))
        pair = np.stack([weight * sensitivity * (left > 0), weight * left])[:, :rows, :columns]
        pairs.append(read_only(np.sqrt(rows * columns / (height * width)) * pair))
    return Bands(read_only((1 - np.sum(weights, axis=0)).clip(0) * left), tuple(pairs))


def stacked_bands(of_eyes: tuple[Bands, ...]) -> Bands:
    """Return the bands of several eyes with a leading axis, or those of the first if they are all the same."""
    first = of_eyes[0]
    if all(bands is first for bands in of_eyes):
        return first
    pairs = tuple(np.stack(pair) for pair in zip(*(bands.bands for bands in of_eyes), strict=True))
    return Bands(np.stack([bands.rest for bands in of_eyes]), pairs)


def _weight(steps: FloatArray) -> FloatArray:
    """Return the weight of a band by how many bands away its middle is; those of all bands together are 1."""
    return np.where(np.abs(steps) < 1, 0.5 + 0.5 * np.cos(np.pi * steps), 0.0)


def _grid_size(reach: npt.NDArray[np.bool_]) -> int:
    """Return how many of the lowest cosines a band takes, of those with a weight and no more than there are."""
    wanted = SPARE * (np.flatnonzero(reach).max(initial=0) + 1)
    return min(math.ceil(wanted / GRID_PX) * GRID_PX, len(reach))


def forward(planes: Planes) -> Planes:
    """Return the cosine transform of planes."""
    rows, columns = planes.shape[-2:]
    if max(rows, columns) > PRODUCT_PX:
        return np.asarray(fft.dctn(planes, axes=(-2, -1), norm="ortho"))
    return np.matmul(np.matmul(cosines(rows), planes), cosines(columns).T)


def inverse(spectrum: Planes) -> Planes:
    """Return the planes that a cosine transform is of."""
    rows, columns = spectrum.shape[-2:]
    if max(rows, columns) > PRODUCT_PX:
        return np.asarray(fft.idctn(spectrum, axes=(-2, -1), norm="ortho"))
    return np.matmul(np.matmul(cosines(rows).T, spectrum), cosines(columns))


COSINES = Transform(forward, inverse, np)


@functools.lru_cache(maxsize=64)
def cosines(size: int) -> Planes:
    """Return the matrix of the cosine transform, shape (frequencies, points), whose transpose is its inverse."""
    return read_only(cosine_matrix(size))


def cosine_matrix(size: int) -> FloatArray:
    """Return that matrix with 64 bits."""
    frequencies = np.arange(size)[:, None]
    points = np.arange(size) + 0.5
    rows = np.cos(np.pi * frequencies * points / size) * np.sqrt(2 / size)
    rows[0] /= np.sqrt(2)
    return rows
