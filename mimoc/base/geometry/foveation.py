"""The mapping of foveated pictures: where the light at their points comes from."""

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt
from scipy import special

FloatArray = npt.NDArray[np.float64]


def to_source(points_px: FloatArray, size_px: tuple[int, int], strength: float, radius: str) -> FloatArray:
    """Return where the light at points of a warped picture comes from in the picture as it was drawn.

    What is r from the centre shows what was R expm1((r / R) log1p(s)) / s from it, in the same direction, where s is
    the strength and R what *radius*, a key of `RADII`, reaches to. Points are x and y from the centre, shape (..., 2).
    """
    growth = np.log1p(strength)
    share = RADII[radius](points_px, size_px)[..., None]
    magnification = strength / growth if strength else 1.0
    return points_px * np.asarray(special.exprel(share * growth)) / magnification


RADII: Mapping[str, Callable[[FloatArray, tuple[int, int]], FloatArray]] = {
    "border": lambda points_px, size_px: np.abs(points_px / np.divide(size_px, 2)).max(axis=-1),
    "corner": lambda points_px, size_px: _lengths(points_px) / (np.hypot(*size_px) / 2),
    "edge": lambda points_px, size_px: _lengths(points_px) / (min(size_px) / 2),
}
"""How far points are from the centre, as a share of R, by what R reaches to: the border of the picture in the same
direction, which loses nothing but breaks straight lines at the diagonals; its corners, as in the paper, which loses the
middles of its edges; or the nearest edge, beyond which there is nothing to see."""


def _lengths(points_px: FloatArray) -> FloatArray:
    return np.hypot(points_px[..., 0], points_px[..., 1])
