"""Convex collision shapes of toys."""

import math

import numpy as np

from mimoc.base.geometry.rotations import (
    Quaternion,
    Vec3,
    quaternion_between,
    quaternion_from_axis,
    quaternion_product,
)
from mimoc.compiler.toys import UPRIGHT, Solid

WOOD = 620.0
"""Paper birch at 12 % moisture: specific gravity 0.55, and the water (USDA Wood Handbook 2010, table 5-3b)."""
POLYPROPYLENE = 905.0  # Solid, such as the wall of a cup: 900 to 910 in data sheets by ISO 1183.
TENNIS_BALL = 365.0
"""Hollow rubber and its air: 57.7 g in 6.7 cm (ITF Rules of Tennis: 56.0 to 59.4 g, 6.54 to 6.86 cm)."""
SHELL = 250.0
"""Hollow and moulded. An estimate: 1.5 mm of ABS (1,050) around a body of 2 cm half thickness is 0.2 of its volume."""
THIN_SHELL = 140.0
"""Hollow and blown, as play food and bath toys. An estimate: 1 mm of soft PVC (1,200) around a ball of 5 cm is 0.12."""
PLUSH = 150.0
"""An estimate: 0.3 kg/m² of pile fabric around a ball of 4 cm is 45, its filling 30, and beads weigh it down."""
FELT = 250.0  # Pressed wool felt, of medium density: SAE grades run from 180 to 340.


ORIGIN: Vec3 = (0.0, 0.0, 0.0)
SAG = 0.01  # Distance by which the capsules that a hoop stands on are lower than the others.


def sphere(radius: float, at: Vec3 = ORIGIN) -> Solid:
    """Return a sphere; it touches a floor at one point."""
    return Solid("sphere", (radius,), at)


def ellipsoid(radii: Vec3, at: Vec3 = ORIGIN) -> Solid:
    """Return an ellipsoid with three half axes; it touches a floor at one point."""
    return Solid("ellipsoid", radii, at)


def capsule(start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a capsule whose caps extend beyond its start and end; lying, it touches a floor at two points."""
    return _along("capsule", start, end, radius)


def cylinder(start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a cylinder between the centres of its ends; standing, it touches a floor at four points."""
    return _along("cylinder", start, end, radius)


def block(size: Vec3, at: Vec3 = ORIGIN, quat: Quaternion = UPRIGHT) -> Solid:
    """Return a box with three edge lengths; it touches a floor at four points."""
    return Solid("box", (size[0] / 2, size[1] / 2, size[2] / 2), at, quat)


def turned(axis: Vec3, angle_deg: float) -> Quaternion:
    """Return a rotation about a unit vector by the right-hand rule."""
    return quaternion_from_axis(axis, math.radians(angle_deg))


def wall(radius: float, thickness: float, low: float, high: float, flare: float = 0.0, sides: int = 8) -> list[Solid]:
    """Return a ring of upright boxes, such as the side of a cup.

    Args:
        radius: Outer radius, halfway up.
        thickness: Thickness of the wall.
        low: Height of its lower edge.
        high: Height of its upper edge.
        flare: Difference between the radii of its upper and lower edge.
        sides: Number of boxes.
    """
    lean = math.atan2(flare, high - low)
    leaning = quaternion_from_axis((0.0, 1.0, 0.0), lean)
    size = (
        thickness,
        2 * radius * math.tan(math.pi / sides),
        (high - low) / math.cos(lean) - thickness * math.tan(abs(lean)),
    )
    boxes = []
    for number in range(sides):
        angle = math.tau * number / sides
        out = radius - thickness / 2
        at = (out * math.cos(angle), out * math.sin(angle), (low + high) / 2)
        boxes.append(block(size, at, quaternion_product(quaternion_from_axis((0.0, 0.0, 1.0), angle), leaning)))
    return boxes


def hoop(radius: float, thickness: float, at: Vec3, sides: int = 8, low: tuple[int, ...] = (0, 4)) -> list[Solid]:
    """Return a ring of capsules that lies flat.

    Args:
        radius: Radius of its centre line.
        thickness: Radius of the capsules.
        at: Its centre.
        sides: Number of capsules; the first is on the x axis.
        low: Indices of capsules that are lower, so that the ring stands on few points instead of on all of them.
    """
    corner = radius / math.cos(math.pi / sides) - 0.5 * radius * (1 / math.cos(math.pi / sides) - 1)
    capsules = []
    for number in range(sides):
        start, end = (math.tau * (number + half) / sides for half in (-0.5, 0.5))
        height = at[2] - SAG * (number in low)
        ends = [(at[0] + corner * math.cos(a), at[1] + corner * math.sin(a), height) for a in (start, end)]
        capsules.append(capsule(ends[0], ends[1], thickness))
    return capsules


def _along(type_: str, start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a capsule or a cylinder whose z axis points from start to end."""
    first, last = np.array(start), np.array(end)
    length = float(np.linalg.norm(last - first))
    quat = quaternion_between(np.array([0.0, 0.0, 1.0]), (last - first) / length)
    middle = (first + last) / 2
    pos = (float(middle[0]), float(middle[1]), float(middle[2]))
    return Solid("capsule" if type_ == "capsule" else "cylinder", (radius, length / 2), pos, quat)
