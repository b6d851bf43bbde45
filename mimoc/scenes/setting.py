"""A world before toys are put there."""

from collections.abc import Sequence
from dataclasses import dataclass

from mimoc.body import BodyTree
from mimoc.body.kinematics import FloatArray
from mimoc.looks.wallpaper import CEILINGS, FLOORS, PICTURES, WALLS, Wallpaper
from mimoc.mjcf.furniture import Headlight
from mimoc.mjcf.tree import Light, World

WEIGHTLESS = (0.0, 0.0, 0.0)
ENDLESS_M = (1e3, 1e3)
"""Half size of a floor without walls."""
HEADLIGHT = Headlight((0.66, 0.66, 0.66), (0.08, 0.08, 0.08))

SUN = Light("sun", (1.8, -0.9, 2.4), (-0.6, 0.3, -0.8), (0.46, 0.46, 0.46), castshadow=True)
WINDOW = Light("window", (1.2, -0.6, 3.0), (-0.4, 0.2, -1.0), (0.3, 0.3, 0.3), castshadow=True)
"""The sun indoors."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Where an infant is in a room."""

    x_m: float
    y_m: float
    yaw_rad: float
    """About the vertical, 0 to 2 pi."""


ORIGIN = Placement(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Decor:
    """What a room may be decorated with."""

    floors: Sequence[Wallpaper] = tuple(FLOORS.values())
    ceilings: Sequence[Wallpaper] = tuple(CEILINGS.values())
    walls: Sequence[Wallpaper] = tuple(WALLS.values())
    pictures: Sequence[Wallpaper] = tuple(PICTURES.values())


OWN_DECOR = Decor()
"""Mimoc's own textures."""


@dataclass(frozen=True, slots=True)
class Occupant:
    """The infant that a world is made for."""

    body: BodyTree
    discs: FloatArray
    """The floor that it takes up in all its poses, at the origin: discs by x, y and radius, shape (n, 3), [m]."""


@dataclass(frozen=True, slots=True)
class Setting:
    """A world without toys, and what has a place in it."""

    world: World
    start: Placement = ORIGIN
    """Where the infant is."""
    half_size_m: tuple[float, float] = ENDLESS_M
    """Of the floor that toys can be on, at z = 0, from its middle at the origin."""
