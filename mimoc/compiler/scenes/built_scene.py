"""What the builders of scenes take and return: an infant, and a world before toys are placed in it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimoc.body.kinematics import FloatArray
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.furniture import DirectionalLight, Headlight
from mimoc.compiler.mjcf.world import World

WEIGHTLESS = (0.0, 0.0, 0.0)
ENDLESS_M = (1e3, 1e3)
"""Half size of a floor without walls."""
HEADLIGHT = Headlight((0.66, 0.66, 0.66), (0.08, 0.08, 0.08))

SUN = DirectionalLight("sun", (1.8, -0.9, 2.4), (-0.6, 0.3, -0.8), (0.46, 0.46, 0.46), castshadow=True)
WINDOW = DirectionalLight("window", (1.2, -0.6, 3.0), (-0.4, 0.2, -1.0), (0.3, 0.3, 0.3), castshadow=True)
"""Daylight indoors."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Where an infant is on the floor."""

    x_m: float
    y_m: float
    yaw_rad: float
    """About the vertical, 0 to 2 pi."""


ORIGIN = Placement(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Occupant:
    """The infant that a scene is built for."""

    body: BodyTree
    discs: FloatArray
    """The floor that it covers in all its poses, at the origin: discs by x, y and radius, shape (n, 3), [m].

    Empty if the kind of scene does not need it.
    """


@dataclass(frozen=True, slots=True)
class BuiltScene:
    """A world without toys, where the infant is in it, and where toys can be."""

    world: World
    start: Placement = ORIGIN
    half_size_m: tuple[float, float] = ENDLESS_M
    """Of the floor that toys can be on, at z = 0, from its middle at the origin."""
    origins: Mapping[str, Entry] = field(default_factory=dict)
    """Where its numbers come from, by key in `provenance.json`."""
