"""Blur by visual acuity: contrast is lost towards the finest grating that an eye resolves."""

import functools

import numpy as np
import numpy.typing as npt
from scipy import fft

Pictures = npt.NDArray[np.float32]
"""Shape (..., height, width, colours), 0 to 255."""

ROWS_AND_COLUMNS = (-3, -2)


def blur(pictures: Pictures, gain: Pictures) -> Pictures:
    """Return pictures through an eye's contrast sensitivity, not clipped.

    A cosine transform continues a picture beyond each border as its mirror image, so no border leaks into the opposite
    one, and the mean stays the same.

    Args:
        pictures: Of the size that the gain is for.
        gain: What `contrast_gain` returns.
    """
    spectrum = np.asarray(fft.dctn(pictures, axes=ROWS_AND_COLUMNS))
    spectrum *= gain[..., None]
    return np.asarray(fft.idctn(spectrum, axes=ROWS_AND_COLUMNS, overwrite_x=True))


@functools.lru_cache(maxsize=32)
def contrast_gain(width_px: int, height_px: int, fovy_deg: float, acuity_cpd: float) -> Pictures:
    """Return how much contrast is left of each cosine of a picture, shape (height, width), 1 for its mean; read-only.

    It is max(0, 1 - f / a) for f cycles per degree (López et al. 2025, equation 2), as degrees are at the centre.
    """
    rows, columns = (np.arange(size_px) / (2 * size_px) for size_px in (height_px, width_px))
    frequencies_cpd = np.hypot(rows[:, None], columns) * pixels_per_degree(height_px, fovy_deg)
    gain = np.maximum(0.0, 1 - frequencies_cpd / acuity_cpd).astype(np.float32)
    gain.flags.writeable = False
    return gain


def pixels_per_degree(height_px: int, fovy_deg: float) -> float:
    """Return how many pixels of a pinhole camera's picture a degree takes at its centre."""
    focal_length_px = height_px / (2 * np.tan(np.radians(fovy_deg) / 2))
    return float(np.radians(focal_length_px))
