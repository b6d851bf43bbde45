"""The choice of toys, and their random places around an infant: densest within its reach, never overlapping."""

import colorsys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from mimoc.base.random_streams import between, pick, stream, whole_between
from mimoc.base.units import cm_to_m
from mimoc.compiler.mjcf.furniture import Rgba
from mimoc.compiler.toys.shape import Tint, ToyModel, radius
from mimoc.schema.toys import ToysSpec

SATURATION, BRIGHTNESS = (0.55, 0.9), (0.65, 0.95)
"""Ranges of the saturation and brightness of a toy's colour; its hue is unrestricted."""
ACCENT = (0.42, 0.58)  # Range of the difference in hue between the two colours of a toy, in turns: about opposite.
DARK: Rgba = (0.13, 0.13, 0.15, 1.0)
LIGHT: Rgba = (0.96, 0.95, 0.92, 1.0)


@dataclass(frozen=True, slots=True)
class Toybox:
    """A set of toys to choose from."""

    names: Sequence[str]
    load: Callable[[str], ToyModel]  # Function that returns the shape of a toy by its name.
    notes: tuple[str, ...] = ()  # Notes for the user of a bundle with such toys.
    progress: Callable[[int, int], None] = field(default=lambda done, total: None, compare=False)
    """Called with the number of a scene's toys that are loaded and their total; a mesh takes long the first time."""


@dataclass(frozen=True, slots=True)
class Toy:
    """A chosen toy, before it is placed."""

    model: ToyModel
    size_m: float  # Length of its longest side.
    yaw_rad: float  # Rotation about the vertical.
    colours: dict[Tint, Rgba]

    @property
    def mass_kg(self) -> float:
        """Mass."""
        return self.model.volume * self.size_m**3 * self.model.density_kg_m3

    @property
    def radius_m(self) -> float:
        """Radius of the smallest vertical cylinder about its origin that encloses its visual and collision geoms."""
        visual = (float(np.linalg.norm(part.mesh.vertices[:, :2], axis=1).max()) for part in self.model.parts)
        return self.size_m * max(*visual, *map(radius, self.model.solids))


def choose_toys(spec: ToysSpec, seed: int, box: Toybox) -> tuple[Toy, ...]:
    """Return a random number of toys from a box; the first n do not depend on the number."""
    count = whole_between(stream(seed, "toys.count"), *spec.count)
    which, sizes, colours, turns = (
        stream(seed, f"toys.{aspect}") for aspect in ("choice", "size", "colour", "orientation")
    )
    low_m, high_m = map(cm_to_m, spec.size_cm)
    toys: list[Toy] = []
    for done in range(count):
        box.progress(done, count)
        model, size_m = box.load(pick(which, box.names)), between(sizes, low_m, high_m)
        toys.append(Toy(model, size_m, between(turns, 0.0, 2 * np.pi), _draw_colours(colours)))
    return tuple(toys)


def _draw_colours(generator: np.random.Generator) -> dict[Tint, Rgba]:
    hue, saturation, brightness = (between(generator, *ends) for ends in ((0.0, 1.0), SATURATION, BRIGHTNESS))
    other = (hue + between(generator, *ACCENT)) % 1.0
    main, accent = (_rgba(turn, saturation, brightness) for turn in (hue, other))
    return {"main": main, "accent": accent, "dark": DARK, "light": LIGHT}


def _rgba(hue: float, saturation: float, brightness: float) -> Rgba:
    red, green, blue = (round(channel, 4) for channel in colorsys.hsv_to_rgb(hue, saturation, brightness))
    return red, green, blue, 1.0


FloatArray = npt.NDArray[np.float64]

GAP_M = 0.01  # Smallest gap between a toy and anything next to it.
FADING = 0.5  # `fading_m` of the reachable floor, in arm lengths.
BATCH, BATCHES = 8, 256
"""Number of random positions that are tried at once, and number of such batches before there counts as no space."""


@dataclass(frozen=True, slots=True)
class ReachableFloor:
    """The part of the floor that an infant's hands can reach."""

    centre_m: tuple[float, float]  # Midpoint between its shoulders, projected onto the floor.
    radius_m: float  # Radius around the centre within which its hands reach the floor.
    fading_m: float  # Distance over which the density of toys beyond the radius falls by a factor of e.

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

    half_size_m: tuple[float, float]  # Half lengths along x and y; the origin is in the middle.
    taken_m: FloatArray  # Occupied discs: x, y and radius, shape (n, 3).


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
