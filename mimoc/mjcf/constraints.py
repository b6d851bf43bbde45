"""Constraints in MJCF: locked hinges, welded bodies and listed contacts."""

from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3


@dataclass(frozen=True, slots=True)
class Lock:
    """A constraint that keeps a hinge at an angle."""

    name: str
    joint: str
    angle_rad: float
    active: bool
    """Whether it is active from the start; others can be switched on."""


@dataclass(frozen=True, slots=True)
class Weld:
    """A constraint that fixes a part of the infant in the world."""

    name: str
    body: str
    anchor_m: Vec3
    """The point that is fixed, in the frame of the body."""
    pos_m: Vec3
    """Where that point is in the world."""
    quat: tuple[float, float, float, float]
    """Orientation."""
    torquescale: float
    """1 fixes the orientation; 0 leaves it free about the point."""


@dataclass(frozen=True, slots=True)
class Pair:
    """Two geoms that collide although their contact bits say otherwise."""

    geom1: str
    geom2: str
    condim: int
    friction: tuple[float, float, float, float, float]
    """Sliding along two axes, spinning, and rolling about two axes."""
    solref: tuple[float, float]
    solimp: tuple[float, float, float, float, float]
