"""What an infant's MJCF has besides the joints, geoms and tendons of its body, in SI units."""

from collections.abc import Iterator
from dataclasses import dataclass

from mimoc.base.geometry.rotations import Vec3
from mimoc.body.tree import Attributes, Geom, Joint


@dataclass(frozen=True, slots=True)
class Site:
    """A marked point of a body."""

    name: str
    pos_m: Vec3
    radius_m: float
    settings: Attributes = ()


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera: an eye, or one that watches."""

    name: str
    pos_m: Vec3
    euler_rad: Vec3
    fovy_deg: float
    names: tuple[tuple[str, str], ...] = ()
    """What it follows, if it follows anything, as attributes."""


@dataclass(frozen=True, slots=True)
class Node:
    """A body with all that is attached to it."""

    name: str
    pos_m: Vec3
    euler_deg: Vec3
    free_joints: tuple[str, ...] = ()
    joints: tuple[Joint, ...] = ()
    geoms: tuple[Geom, ...] = ()
    sites: tuple[Site, ...] = ()
    cameras: tuple[Camera, ...] = ()
    children: tuple["Node", ...] = ()

    def subtree(self) -> Iterator["Node"]:
        """Yield this body and its descendants, each before its children."""
        yield self
        for child in self.children:
            yield from child.subtree()


@dataclass(frozen=True, slots=True)
class Actuator:
    """An actuator of a joint."""

    name: str
    mimo_actuator: str  # The actuator of MIMo that it corresponds to, alone or with others.
    joint: str
    gear: float
    control_range: tuple[float, float]
    settings: Attributes
    tone: tuple[float, ...] = ()
    """What a quiet infant's muscle tone adds, in proportion to arousal: to the three numbers of `biasprm`, or, as two
    numbers, to the stiffness of its hinge and to stiffness x rest angle. Empty is no tone."""


@dataclass(frozen=True, slots=True)
class PassiveActuator:
    """An actuator of a joint that takes no commands: its torque is its bias, within its force range."""

    name: str
    joint: str
    bias: tuple[float, ...]  # Torque at angle and speed 0, and by angle and speed.
    force_range: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Sensor:
    """A MuJoCo sensor at a site."""

    kind: str
    name: str
    site: str
