"""Plane sections of primitive solids: how far they reach, and how long a tape around several of them is."""

import math
from dataclasses import dataclass

import numpy as np

from mimoc.base.geometry.primitives import Extents
from mimoc.base.geometry.rotations import FloatArray

_STEEPEST_RAD = math.pi / 2 - 1e-3
_GOLDEN = (math.sqrt(5) - 1) / 2
_ROUNDS = 50
"""Each makes an interval .62 times as long: to ten digits."""
DIRECTIONS = 360
"""Directions in which a tape is taken to touch; the girth of a trunk is then exact to 1e-5."""


@dataclass(frozen=True, slots=True)
class Solids:
    """Some primitives in their places."""

    extents: Extents
    """Of each of n from its centre."""
    centres: FloatArray
    """Shape (n, 3)."""
    rotations: FloatArray
    """World from primitive, shape (n, 3, 3)."""

    def reaches(self, directions: FloatArray) -> FloatArray:
        """Return how far each reaches from the origin along vectors (..., n, 3), times their length, (..., n)."""
        local = np.einsum("nij,...ni->...nj", self.rotations, directions)
        return (directions * self.centres).sum(axis=-1) + self.extents.along(local)

    def span(self, direction: FloatArray) -> tuple[float, float]:
        """Return the least and the largest reach of all along a unit vector, shape (3,)."""
        towards = self._all(direction)
        return -float(self.reaches(-towards).max()), float(self.reaches(towards).max())

    def section_reach(self, normal: FloatArray, offset: float, directions: FloatArray) -> FloatArray:
        """Return how far the section with a plane reaches from the origin in directions within the plane, shape (m,).

        A point of the plane at x has normal @ x = offset. The section of a convex solid reaches as far as the least of
        all half-spaces that hold the solid, tilted about lines in the plane; solids that the plane misses do not count.

        Args:
            normal: Unit vector, shape (3,).
            offset: Of the plane from the origin.
            directions: Unit vectors, orthogonal to the normal, shape (m, 3).
        """
        low_m, high_m = -self.reaches(-self._all(normal)), self.reaches(self._all(normal))
        met = (low_m < offset) & (offset < high_m)
        return np.where(met, self._least_half_space(normal, offset, directions), -np.inf).max(axis=1)

    def girth(self, normal: FloatArray, offset: float) -> float:
        """Return the length of a tape around the section with a plane, which spans hollows (Cauchy's formula)."""
        angle_rad = np.arange(DIRECTIONS) * (2 * math.pi / DIRECTIONS)
        first = np.linalg.svd(normal[None])[2][1]
        second = np.cross(normal, first)
        around = np.cos(angle_rad)[:, None] * first + np.sin(angle_rad)[:, None] * second
        return float(2 * math.pi * self.section_reach(normal, offset, around).mean())

    def _all(self, vector: FloatArray) -> FloatArray:
        return np.broadcast_to(vector, self.centres.shape)

    def _least_half_space(self, normal: FloatArray, offset: float, directions: FloatArray) -> FloatArray:
        """Return the least reach over all tilts of a half-space out of the plane, shape (m, n), by golden section."""

        def reach(tilt_rad: FloatArray) -> FloatArray:
            slope = np.tan(tilt_rad)
            return self.reaches(directions[:, None] + slope[..., None] * normal) - slope * offset

        shape = (len(directions), len(self.centres))
        low, high = np.full(shape, -_STEEPEST_RAD), np.full(shape, _STEEPEST_RAD)
        for _ in range(_ROUNDS):
            left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            lower = reach(left) < reach(right)
            low, high = np.where(lower, low, left), np.where(lower, right, high)
        return reach((low + high) / 2)
