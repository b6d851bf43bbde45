"""Constraints in MJCF: locked hinges, welded bodies and listed contacts."""

from dataclasses import dataclass

from mimoc.body.tree import Vec3


@dataclass(frozen=True, slots=True)
class Lock:
    """A constraint that keeps a hinge at an angle."""

    name: str
    joint: str
    angle_rad: float
    active: bool
    """Whether it does so from the start; others are there to be switched on."""


@dataclass(frozen=True, slots=True)
class Weld:
    """A constraint that keeps a part of the infant where it is in the world."""

    name: str
    body: str
    anchor_m: Vec3
    """The point that is kept, in the frame of the body."""
    pos_m: Vec3
    """Where that point is kept."""
    quat: tuple[float, float, float, float]
    """How it is turned."""
    torquescale: float
    """1 to keep how it is turned; 0 lets it turn about the point."""


@dataclass(frozen=True, slots=True)
class Pair:
    """Two geoms that touch though their contact bits say that they do not."""

    geom1: str
    geom2: str
    condim: int
    friction: tuple[float, float, float, float, float]
    """Sliding along two axes, spinning, and rolling about two axes."""
    solref: tuple[float, float]
    solimp: tuple[float, float, float, float, float]
