"""Defocus: what is nearer or farther than an eye is focused on is blurred, by the disc that its light spreads to.

    defocus = unfocused |1 / d - 1 / .25 m| - depth of focus     in dioptres, at a distance d
    diameter of the disc = .057 x defocus x pupil in mm          in degrees (by geometry: 1 / 1000 rad)

A picture is blurred by discs of a few sizes, and each pixel is interpolated between the two nearest sizes by its own
distance. So the blur of what is near does not spread over what is behind it.
"""

import functools
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft, special

from mimoc.components.senses.vision.foveation import ROWS_AND_COLUMNS, Pictures, pixels_per_degree

FloatArray = npt.NDArray[np.float64]

FOCUSED_M = 0.25
"""Distance that newborns' eyes are focused on: between Haynes, White & Held's 19 cm (1965) and Hainline et al.'s 30
(1992)."""
PUPIL_MM = 4.5
"""Diameter of the pupil: assumed, 4 to 5."""
DEG_PER_DIOPTRE_MM = float(np.degrees(1e-3))
"""Angle of the disc by defocus and pupil."""
NEAREST_M = 0.1
"""Nearer things are blurred as there."""
SIZES = (0.5, 1.0)
"""Discs by which pictures are blurred, relative to the largest, besides none."""


@dataclass(frozen=True, slots=True)
class Lens:
    """An eye's focus."""

    unfocused: float
    """Share of the distance in dioptres from `FOCUSED_M` by which it is out of focus."""
    depth_dioptres: float
    """Defocus that blurs nothing."""

    def disc_deg(self, distance_m: npt.NDArray[np.floating] | float) -> FloatArray:
        """Return the diameter of the disc that a point at a distance is seen as."""
        away = np.abs(1 / np.maximum(distance_m, NEAREST_M) - 1 / FOCUSED_M)
        return DEG_PER_DIOPTRE_MM * PUPIL_MM * np.maximum(self.unfocused * away - self.depth_dioptres, 0)


def defocus(pictures: Pictures, distances_m: npt.NDArray[np.float32], lens: Lens, fovy_deg: float) -> Pictures:
    """Return pictures out of focus.

    Args:
        pictures: Shape (..., height, width, colours).
        distances_m: Of what each pixel shows from the eye, along the line of sight, shape (..., height, width).
        lens: The eye's focus.
        fovy_deg: Vertical field of view.
    """
    largest_deg = float(lens.disc_deg(NEAREST_M))
    if not largest_deg:
        return pictures
    spectrum = np.asarray(fft.dctn(pictures, axes=ROWS_AND_COLUMNS))
    height, width = pictures.shape[-3:-1]
    step = len(SIZES) * lens.disc_deg(distances_m).astype(np.float32) / np.float32(largest_deg)
    seen = pictures * (1 - step).clip(0)[..., None]
    for number, size in enumerate(SIZES, start=1):
        gain = disc_gain(width, height, fovy_deg, size * largest_deg)[..., None]
        blurred = np.asarray(fft.idctn(spectrum * gain, axes=ROWS_AND_COLUMNS))
        seen += blurred * (1 - np.abs(step - number)).clip(0)[..., None]
    return seen


@functools.lru_cache(maxsize=32)
def disc_gain(width_px: int, height_px: int, fovy_deg: float, disc_deg: float) -> npt.NDArray[np.float32]:
    """Return how much is left of each cosine of a picture that is blurred by a disc, shape (height, width); read-only.

    It is 2 J1(x) / x with x = pi disc f; where that is negative, gratings are seen with dark and light exchanged.
    """
    rows, columns = (np.arange(size_px) / (2 * size_px) for size_px in (height_px, width_px))
    frequencies_cpd = np.hypot(rows[:, None], columns) * pixels_per_degree(height_px, fovy_deg)
    x = np.maximum(np.pi * disc_deg * frequencies_cpd, 1e-9)
    gain = (2 * special.j1(x) / x).astype(np.float32)
    gain.flags.writeable = False
    return gain


def distances(depths: npt.NDArray[np.float32], near_m: float, far_m: float) -> npt.NDArray[np.float32]:
    """Return distances along the line of sight from OpenGL's depths, 0 at the near and 1 at the far plane."""
    return np.float32(near_m) / (1 - depths * np.float32(1 - near_m / far_m))
