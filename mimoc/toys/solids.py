"""Convex shapes that toys touch with, placed by their ends, with their reach and volume."""

import math

import numpy as np

from mimoc.body.tree import Vec3
from mimoc.toys.model import UPRIGHT, FloatArray, Quaternion, Solid

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
    half = math.radians(angle_deg) / 2
    x, y, z = (math.sin(half) * component for component in axis)
    return (math.cos(half), x, y, z)


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
        boxes.append(
            block(
                size,
                at,
                _times(turned((0.0, 0.0, 1.0), math.degrees(angle)), turned((0.0, 1.0, 0.0), math.degrees(lean))),
            )
        )
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
    at, spread = np.array(solid.pos), _spread(solid)
    return at - spread, at + spread


def radius(solid: Solid) -> float:
    """Return how far a solid reaches at most from the vertical through the origin."""
    at, axes, sizes = np.array(solid.pos), _rotation(solid.quat), np.array(solid.size)
    if solid.mesh is not None:
        return float(np.linalg.norm((at + solid.mesh.vertices @ axes.T)[:, :2], axis=1).max())
    local, along = _AROUND @ axes, np.abs(_AROUND @ axes[:, 2])
    if solid.type == "box":
        spread = np.abs(local) @ sizes
    elif solid.type == "ellipsoid":
        spread = np.linalg.norm(local * sizes, axis=1)
    elif solid.type == "cylinder":
        spread = sizes[0] * np.sqrt(np.maximum(0.0, 1 - along**2)) + sizes[1] * along
    else:
        spread = sizes[0] + (sizes[1] * along if solid.type == "capsule" else 0.0)
    return float((_AROUND @ at + spread).max()) / math.cos(math.pi / len(_AROUND))


def solid_volume(solid: Solid) -> float:
    """Return the volume of a primitive."""
    sizes = solid.size
    if solid.type == "box":
        return 8 * math.prod(sizes)
    if solid.type == "cylinder":
        return math.tau * sizes[0] ** 2 * sizes[1]
    if solid.type == "capsule":
        return math.tau * sizes[0] ** 2 * (sizes[1] + sizes[0] * 2 / 3)
    return math.tau * 2 / 3 * (sizes[0] ** 3 if solid.type == "sphere" else math.prod(sizes))


def _spread(solid: Solid) -> FloatArray:
    """Return how far a primitive reaches from its middle along x, y and z."""
    sizes, axes = np.array(solid.size), _rotation(solid.quat)
    if solid.type == "sphere":
        return np.full(3, sizes[0])
    if solid.type == "capsule":
        return sizes[0] + sizes[1] * np.abs(axes[:, 2])
    if solid.type == "cylinder":
        return sizes[0] * np.sqrt(np.maximum(0.0, 1 - axes[:, 2] ** 2)) + sizes[1] * np.abs(axes[:, 2])
    if solid.type == "box":
        return np.abs(axes) @ sizes
    return np.sqrt(axes**2 @ sizes**2)


def _along(type_: str, start: Vec3, end: Vec3, radius: float) -> Solid:
    """Return a capsule or a cylinder whose z axis runs from start to end."""
    first, last = np.array(start), np.array(end)
    length = float(np.linalg.norm(last - first))
    x, y, z = (last - first) / length
    quat = (0.0, 1.0, 0.0, 0.0) if z < -1 + 1e-9 else _normal((1 + float(z), -float(y), float(x), 0.0))
    middle = (first + last) / 2
    pos = (float(middle[0]), float(middle[1]), float(middle[2]))
    return Solid("capsule" if type_ == "capsule" else "cylinder", (radius, length / 2), pos, quat)


def _rotation(quat: Quaternion) -> FloatArray:
    """Return the rotation matrix of a unit quaternion."""
    w, x, y, z = quat
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _normal(quat: Quaternion) -> Quaternion:
    length = math.sqrt(sum(component**2 for component in quat))
    w, x, y, z = (component / length for component in quat)
    return (w, x, y, z)


def _times(left: Quaternion, right: Quaternion) -> Quaternion:
    """Return the rotation that does the right one first."""
    a, b, c, d = left
    e, f, g, h = right
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )
