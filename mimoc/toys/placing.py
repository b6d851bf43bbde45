"""Where toys lie: around an infant, densest within its reach, and clear of everything else."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

GAP_M = 0.01
"""Between a toy and whatever is next to it."""
FADING = 0.5
"""`fading_m` of the reachable floor, in lengths of an arm."""
AT_ONCE, TRIES = 8, 256
"""Places that are drawn for a toy at once, and how often before it counts as having no room."""


@dataclass(frozen=True, slots=True)
class ReachableFloor:
    """The part of the floor that an infant's hands can reach."""

    centre_m: tuple[float, float]
    """The middle between its shoulders, seen from above."""
    radius_m: float
    """How far from there its hands reach things on the floor."""
    fading_m: float
    """Distance over which the density of toys beyond that falls by a factor of e."""

    def density(self, distance_m: FloatArray) -> FloatArray:
        """Return the density of toys at a distance from the centre, relative to that within reach."""
        return np.exp(-np.maximum(distance_m - self.radius_m, 0.0) / self.fading_m)

    def draw(self, count: int, generator: np.random.Generator) -> FloatArray:
        """Return places that are as dense as `density` says, shape (count, 2), [m]."""
        distance_m = self._draw_distances(count, generator)
        angle = 2 * np.pi * generator.random(count)
        return self.centre_m + distance_m[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def _draw_distances(self, count: int, generator: np.random.Generator) -> FloatArray:
        """Return distances whose density is that of places times their circumference.

        Within the radius R that is r; beyond it, at r = R + t, it is R exp(-t/f) + t exp(-t/f).
        """
        radius_m, fading_m = self.radius_m, self.fading_m
        weights = np.cumsum([radius_m**2 / 2, radius_m * fading_m, fading_m**2])
        part = np.searchsorted(weights, weights[-1] * generator.random(count), side="right")
        within = radius_m * np.sqrt(generator.random(count))
        beyond = -fading_m * np.log1p(-generator.random((2, count)))
        return np.choose(part, [within, radius_m + beyond[0], radius_m + beyond.sum(axis=0)])


@dataclass(frozen=True, slots=True)
class Floor:
    """A floor, and what stands on it."""

    half_size_m: tuple[float, float]
    """From its middle, the origin, to its borders."""
    taken_m: FloatArray
    """Discs that are taken: x, y and radius, shape (n, 3)."""


def place_toys(
    radii_m: Sequence[float], reach: ReachableFloor, floor: Floor, generator: np.random.Generator
) -> FloatArray | None:
    """Return a place for each toy, shape (n, 2), or None if there is no room for one of them.

    A place that is not free is drawn anew, so that on the free floor toys are as dense as *reach* says.

    Args:
        radii_m: Of the toys, seen from above.
        reach: Where they are likely.
        floor: Where they can be.
        generator: What to draw from.
    """
    taken = list(map(tuple, floor.taken_m))
    places = np.empty((len(radii_m), 2))
    for index, radius_m in enumerate(radii_m):
        for _ in range(TRIES):
            drawn = reach.draw(AT_ONCE, generator)
            free = np.flatnonzero(_is_free(drawn, radius_m, floor.half_size_m, np.array(taken).reshape(-1, 3)))
            if free.size:
                break
        else:
            return None
        places[index] = drawn[free[0]]
        taken.append((*places[index], radius_m))
    return places


def _is_free(
    places_m: FloatArray, radius_m: float, half_size_m: tuple[float, float], taken_m: FloatArray
) -> npt.NDArray[np.bool_]:
    inside = (np.abs(places_m) + radius_m + GAP_M <= half_size_m).all(axis=1)
    gaps_m = np.linalg.norm(places_m[:, None] - taken_m[:, :2], axis=2) - taken_m[:, 2] - radius_m
    return inside & (gaps_m >= GAP_M).all(axis=1)
