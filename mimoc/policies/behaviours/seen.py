"""What an infant makes of its own pictures: how much stands out where, by contrast, by motion, and by faces."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from mimoc.base.geometry.foveation import RADII, to_source
from mimoc.runtime.sense import FloatArray

MAX_CELLS = 32  # Rows of cells that a picture is averaged down to, at most: some 2 degrees each (a choice).
SURROUND = 5  # Cells across that a cell stands out from.
CONTRAST, MOTION, FACE = "contrast", "motion", "face"
FEATURES = (CONTRAST, MOTION, FACE)
LUMINANCE = np.array([0.299, 0.587, 0.114])
LEAST_LUMINANCE = 0.05  # Darker pictures do not make more of their contrasts.
SKIN_RED_OVER_GREEN, SKIN_GREEN_OVER_BLUE = (1.08, 1.9), (1.02, 1.9)
"""Ratios of colours within which a cell counts as skin, of any tone (a choice: faces are patches of skin)."""
SKIN_CONTRAST, SPOT_CONTRAST = 0.2, 0.1
"""Contrasts from which on a patch of skin with eyes, brows and a mouth in it, or three dark spots, count fully."""
SPOTS_APART, PATTERN_SHARE = (1, 2, 3), 0.7
"""How many cells spots are to the side of the middle of a face, and above and below it; and what a pattern counts for,
beside a face in colours (choices)."""


@dataclass(frozen=True)
class Retina:
    """The directions that the pixels of an eye's pictures show, in the frame of its camera."""

    width_px: int
    height_px: int
    fovy_deg: float
    foveation: float = 0.0  # Its strength; 0 is none.
    foveation_radius: str = "corner"

    @cached_property
    def cell_px(self) -> int:
        """Pixels across a cell."""
        return max(1, math.ceil(min(self.height_px, self.width_px) / MAX_CELLS))

    @cached_property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of cells."""
        return self.height_px // self.cell_px, self.width_px // self.cell_px

    @cached_property
    def middles_px(self) -> FloatArray:
        """The middles of cells, x and y from the centre of the picture, shape (rows, columns, 2)."""
        rows, columns = self.shape
        indices = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1)
        return np.asarray((indices + 0.5) * self.cell_px - np.divide(self._size_px, 2), np.float64)

    @property
    def _size_px(self) -> tuple[int, int]:
        return self.width_px, self.height_px

    @cached_property
    def directions(self) -> FloatArray:
        """Unit vectors, shape (rows, columns, 3): x to the right, y up, -z ahead."""
        points_px = self.middles_px
        if self.foveation:
            points_px = to_source(points_px, self._size_px, self.foveation, self.foveation_radius)
        slopes = points_px / (self.height_px / 2) * math.tan(math.radians(self.fovy_deg) / 2)
        vectors = np.stack([slopes[..., 0], -slopes[..., 1], -np.ones(self.shape)], axis=-1)
        return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)

    @cached_property
    def is_shown(self) -> npt.NDArray[np.bool_]:
        """Which cells show something, shape (rows, columns): foveated pictures can have black rims."""
        if not self.foveation:
            return np.ones(self.shape, np.bool_)
        return RADII[self.foveation_radius](self.middles_px, self._size_px) <= 1.0

    def cells(self, picture: npt.NDArray[np.uint8]) -> FloatArray:
        """Return the mean colour of each cell, shape (rows, columns, 3), 0 to 1."""
        rows, columns = self.shape
        size = self.cell_px
        parts = picture[: rows * size, : columns * size].reshape(rows, size, columns, size, 3)
        return parts.mean(axis=(1, 3)) / 255.0


def contrast_of(cells: FloatArray) -> FloatArray:
    """Return by how much each cell is lighter or darker than what surrounds it, as a share of the mean luminance."""
    luminance = cells @ LUMINANCE
    surround = ndimage.uniform_filter(luminance, SURROUND, mode="nearest")
    return np.abs(luminance - surround) / max(float(luminance.mean()), LEAST_LUMINANCE)


def motion_of(cells: FloatArray, before: FloatArray) -> FloatArray:
    """Return by how much each cell has become lighter or darker since a picture from the same eye at the same place."""
    change = np.abs((cells - before) @ LUMINANCE)
    return ndimage.uniform_filter(change, 3, mode="nearest") / max(float((cells @ LUMINANCE).mean()), LEAST_LUMINANCE)


def face_of(cells: FloatArray) -> FloatArray:
    """Return how much each cell looks like the middle of a face, 0 to 1.

    That is a patch of skin colour with darker things in it, or, without colours, two dark spots above one dark spot
    (the pattern that newborns follow, Johnson & Morton 1991). A hand or a foot looks a little like a face.
    """
    red, green, blue = np.moveaxis(cells + 1e-3, -1, 0)
    is_skin = np.ones(cells.shape[:2])
    for ratio, (low, high) in ((red / green, SKIN_RED_OVER_GREEN), (green / blue, SKIN_GREEN_OVER_BLUE)):
        is_skin *= (low < ratio) & (ratio < high)
    patch = ndimage.uniform_filter(is_skin, SURROUND, mode="constant")
    inner = ndimage.uniform_filter(contrast_of(cells), 3, mode="nearest")
    by_colour = patch * np.minimum(inner / SKIN_CONTRAST, 1.0)
    by_pattern = np.minimum(_three_spots(cells @ LUMINANCE) / SPOT_CONTRAST, 1.0)
    return np.maximum(by_colour, PATTERN_SHARE * by_pattern)


def _three_spots(luminance: FloatArray) -> FloatArray:
    """Return how dark three spots around each cell are, two above and one below, and how light it is between them.

    The lightest of the spots counts, at the best of some sizes.
    """
    mean = max(float(luminance.mean()), LEAST_LUMINANCE)
    dark = (ndimage.uniform_filter(luminance, SURROUND, mode="nearest") - luminance) / mean
    rows, columns = luminance.shape
    best = np.zeros(luminance.shape)
    for size in SPOTS_APART:
        padded = np.pad(dark, size)
        left, right = padded[:rows, :columns], padded[:rows, 2 * size : 2 * size + columns]
        below = padded[2 * size : 2 * size + rows, size : size + columns]
        between = np.maximum(dark, padded[:rows, size : size + columns])
        best = np.maximum(best, np.minimum(np.minimum(left, right), below) - np.maximum(between, 0.0))
    return best
