"""Convex shapes that toys touch with, placed by their ends, with their reach and volume."""

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
"""Directions on the floor."""
SAG = 0.01
"""How much lower than the others lies what a ring stands on."""


def sphere(radius: float, at: Vec3 = ORIGIN) -> Solid:
    """Return a sphere; it touches a floor at one point."""
    return Solid("sphere", (radius,), at)


def ellipsoid(radii: Vec3, at: Vec3 = ORIGIN) -> Solid:
    """Return an ellipsoid of three half axes; it touches a floor at one point."""
    return Solid("ellipsoid", radii, at)


def capsule(start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a capsule, whose caps reach beyond its start and end; one that lies touches a floor at two points."""
    return _along("capsule", start, end, radius)


def cylinder(start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a cylinder between the middles of its ends; one that stands touches a floor at four points."""
    return _along("cylinder", start, end, radius)


def block(size: Vec3, at: Vec3 = ORIGIN, quat: Quaternion = UPRIGHT) -> Solid:
    """Return a box of three edge lengths; it touches a floor at four points."""
    return Solid("box", (size[0] / 2, size[1] / 2, size[2] / 2), at, quat)


def turned(axis: Vec3, angle_deg: float) -> Quaternion:
    """Return a rotation about a unit vector, counterclockwise for who looks back along it."""
    return quaternion_from_axis(axis, math.radians(angle_deg))


def wall(radius: float, thickness: float, low: float, high: float, flare: float = 0.0, sides: int = 8) -> list[Solid]:
    """Return a ring of upright boxes, as the side of a cup.

    Args:
        radius: Outer radius, halfway up.
        thickness: Of the wall.
        low: Height of its lower edge.
        high: Height of its upper edge.
        flare: By how much it is wider above than below.
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
    """Return a ring of capsules that lies flat, of a tube of a half thickness.

    Args:
        radius: Of its middle line.
        thickness: Half of that of the tube.
        at: Its middle.
        sides: Number of capsules, counted from the one at x.
        low: Those that lie lower, so that the ring stands on few points instead of on all of them.
    """
    corner = radius / math.cos(math.pi / sides) - 0.5 * radius * (1 / math.cos(math.pi / sides) - 1)
    capsules = []
    for number in range(sides):
        start, end = (math.tau * (number + half) / sides for half in (-0.5, 0.5))
        height = at[2] - SAG * (number in low)
        ends = [(at[0] + corner * math.cos(a), at[1] + corner * math.sin(a), height) for a in (start, end)]
        capsules.append(capsule(ends[0], ends[1], thickness))
    return capsules


def reach(solid: Solid) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest corner of the box around a solid."""
    at, spread = np.array(solid.pos), _extents(solid).along(matrix_from_quaternion(solid.quat)[:, None])[:, 0]
    return at - spread, at + spread


def radius(solid: Solid) -> float:
    """Return how far a solid reaches at most from the vertical through the origin."""
    at, axes = np.array(solid.pos), matrix_from_quaternion(solid.quat)
    if solid.mesh is not None:
        return float(np.linalg.norm((at + solid.mesh.vertices @ axes.T)[:, :2], axis=1).max())
    spread = _extents(solid).along((_AROUND @ axes)[:, None])[:, 0]
    return float((_AROUND @ at + spread).max()) / math.cos(math.pi / len(_AROUND))


def solid_volume(solid: Solid) -> float:
    """Return the volume of a solid."""
    return mesh_volume(solid.mesh) if solid.mesh else primitives.volume(_kind(solid), solid.size)


def _extents(solid: Solid) -> Extents:
    """Return how far a primitive reaches, as the only one."""
    return extents([(_kind(solid), solid.size)])


def _kind(solid: Solid) -> Kind:
    assert solid.type != "mesh"
    return solid.type


def _along(type_: str, start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a capsule or a cylinder whose z axis runs from start to end."""
    first, last = np.array(start), np.array(end)
    length = float(np.linalg.norm(last - first))
    quat = quaternion_between(np.array([0.0, 0.0, 1.0]), (last - first) / length)
    middle = (first + last) / 2
    pos = (float(middle[0]), float(middle[1]), float(middle[2]))
    return Solid("capsule" if type_ == "capsule" else "cylinder", (radius, length / 2), pos, quat)
