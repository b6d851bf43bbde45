"""Random placement of toys on the floor around an infant, densest within its reach and without overlaps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

GAP_M = 0.01
"""Smallest gap between a toy and anything next to it."""
FADING = 0.5
"""`fading_m` of the reachable floor, in arm lengths."""
BATCH, BATCHES = 8, 256
"""Number of random positions that are tried at once, and number of such batches before there counts as no space."""


@dataclass(frozen=True, slots=True)
class ReachableFloor:
    """The part of the floor that an infant's hands can reach."""

    centre_m: tuple[float, float]
    """Midpoint between its shoulders, projected onto the floor."""
    radius_m: float
    """Radius around the centre within which its hands reach the floor."""
    fading_m: float
    """Distance over which the density of toys beyond the radius falls by a factor of e."""

    def density(self, distance_m: FloatArray) -> FloatArray:
        """Return the density of toys at a distance from the centre, relative to the density within reach."""
        return np.exp(-np.maximum(distance_m - self.radius_m, 0.0) / self.fading_m)

    def draw(self, count: int, generator: np.random.Generator) -> FloatArray:
        """Return random positions distributed according to `density`, shape (count, 2), [m]."""
        distance_m = self._draw_distances(count, generator)
        angle = 2 * np.pi * generator.random(count)
        return self.centre_m + distance_m[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def _draw_distances(self, count: int, generator: np.random.Generator) -> FloatArray:
        """Return random distances from the centre, whose density is `density` times the circumference.

        Within the radius R it is r; beyond it, at r = R + t, it is R exp(-t/f) + t exp(-t/f).
        """
        radius_m, fading_m = self.radius_m, self.fading_m
        weights = np.cumsum([radius_m**2 / 2, radius_m * fading_m, fading_m**2])
        part = np.searchsorted(weights, weights[-1] * generator.random(count), side="right")
        within = radius_m * np.sqrt(generator.random(count))
        beyond = -fading_m * np.log1p(-generator.random((2, count)))
        return np.choose(part, [within, radius_m + beyond[0], radius_m + beyond.sum(axis=0)])


@dataclass(frozen=True, slots=True)
class Floor:
    """A floor and its occupied areas."""

    half_size_m: tuple[float, float]
    """Half lengths along x and y; the origin is in the middle."""
    taken_m: FloatArray
    """Occupied discs: x, y and radius, shape (n, 3)."""


def place_toys(
    radii_m: Sequence[float], reach: ReachableFloor, floor: Floor, generator: np.random.Generator
) -> FloatArray | None:
    """Return a position for each toy, shape (n, 2), or None if there is no space for one of them.

    Positions are drawn by rejection, so that on the free floor the density of toys, whose radii are seen from above, is
    that of *reach*.
    """
    taken = list(map(tuple, floor.taken_m))
    places = np.empty((len(radii_m), 2))
    for index, radius_m in enumerate(radii_m):
        for _ in range(BATCHES):
            drawn = reach.draw(BATCH, generator)
            taken_m = np.array(taken).reshape(-1, 3)
            inside = (np.abs(drawn) + radius_m + GAP_M <= floor.half_size_m).all(axis=1)
            gaps_m = np.linalg.norm(drawn[:, None] - taken_m[:, :2], axis=2) - taken_m[:, 2] - radius_m
            free = np.flatnonzero(inside & (gaps_m >= GAP_M).all(axis=1))
            if free.size:
                break
        else:
            return None
        places[index] = drawn[free[0]]
        taken.append((*places[index], radius_m))
    return places
