"""Convex collision shapes of toys, with their bounds and volume."""

import math

import numpy as np

from mimoc.geometry import primitives
from mimoc.geometry.primitives import Extents, Kind, extents
from mimoc.geometry.rotations import (
    FloatArray,
    Quaternion,
    Vec3,
    matrix_from_quaternion,
    quaternion_between,
    quaternion_from_axis,
    quaternion_product,
)
from mimoc.toys.model import UPRIGHT, Solid
from mimoc.toys.transforms import mesh_volume

ORIGIN: Vec3 = (0.0, 0.0, 0.0)
_ANGLES = np.linspace(0, math.tau, 48, endpoint=False)
_AROUND = np.stack([np.cos(_ANGLES), np.sin(_ANGLES), np.zeros(48)], axis=1)
"""Horizontal directions."""
SAG = 0.01
"""Distance by which the capsules that a hoop stands on are lower than the others."""


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


def bounds(solid: Solid) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of a solid's axis-aligned bounding box."""
    at, extent = np.array(solid.pos), _extents(solid).along(matrix_from_quaternion(solid.quat)[:, None])[:, 0]
    return at - extent, at + extent


def radius(solid: Solid) -> float:
    """Return the largest distance of a solid's points from the z axis."""
    at, axes = np.array(solid.pos), matrix_from_quaternion(solid.quat)
    if solid.mesh is not None:
        return float(np.linalg.norm((at + solid.mesh.vertices @ axes.T)[:, :2], axis=1).max())
    extent = _extents(solid).along((_AROUND @ axes)[:, None])[:, 0]
    return float((_AROUND @ at + extent).max()) / math.cos(math.pi / len(_AROUND))


def solid_volume(solid: Solid) -> float:
    """Return the volume of a solid."""
    return mesh_volume(solid.mesh) if solid.mesh else primitives.volume(_kind(solid), solid.size)


def _extents(solid: Solid) -> Extents:
    """Return the extents of a single primitive."""
    return extents([(_kind(solid), solid.size)])


def _kind(solid: Solid) -> Kind:
    assert solid.type != "mesh"
    return solid.type


def _along(type_: str, start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a capsule or a cylinder whose z axis points from start to end."""
    first, last = np.array(start), np.array(end)
    length = float(np.linalg.norm(last - first))
    quat = quaternion_between(np.array([0.0, 0.0, 1.0]), (last - first) / length)
    middle = (first + last) / 2
    pos = (float(middle[0]), float(middle[1]), float(middle[2]))
    return Solid("capsule" if type_ == "capsule" else "cylinder", (radius, length / 2), pos, quat)
