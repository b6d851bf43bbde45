"""Closed meshes for the visual geoms of toys: surfaces of revolution, sweeps, extrusions and boxes.

All are lofts over a sequence of rings, computed with NumPy only, so that no library's release changes a vertex.
"""

import math
from collections.abc import Sequence
from functools import cache
from itertools import accumulate
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray, Vec3, matrix_from_axis
from mimoc.compiler.toys import IntArray, Mesh


def move(mesh: Mesh, by: Vec3) -> Mesh:
    """Return a mesh moved by a vector."""
    return Mesh(mesh.vertices + by, mesh.faces)


def stretch(mesh: Mesh, factors: Vec3) -> Mesh:
    """Return a mesh scaled along x, y and z."""
    return Mesh(mesh.vertices * factors, mesh.faces)


def turn(mesh: Mesh, axis: Literal["x", "y", "z"], angle_deg: float) -> Mesh:
    """Return a mesh turned about an axis through the origin by the right-hand rule."""
    rotation = matrix_from_axis(np.eye(3)["xyz".index(axis)], math.radians(angle_deg))
    return Mesh(mesh.vertices @ rotation.T, mesh.faces)


def mirror(mesh: Mesh) -> Mesh:
    """Return a mesh mirrored at the plane y = 0."""
    return Mesh(mesh.vertices * (1.0, -1.0, 1.0), mesh.faces[:, ::-1])


def pair(mesh: Mesh) -> tuple[Mesh, Mesh]:
    """Return a mesh and its mirror image at the plane y = 0."""
    return mesh, mirror(mesh)


def flatten_below(mesh: Mesh, floor: float = 0.0) -> Mesh:
    """Return a mesh whose vertices below a height are moved up to it."""
    return Mesh(np.maximum(mesh.vertices, (-np.inf, -np.inf, floor)), mesh.faces)


ORIGIN: Vec3 = (0.0, 0.0, 0.0)
ROUND = 16  # Corners of a circle; a multiple of four, so that it spans its box.
COS_45 = math.sqrt(0.5)
Outline = Sequence[tuple[float, float]]
"""Corners in counterclockwise order, of a polygon that is star-shaped about their mean."""


def loft(rings: Sequence[npt.ArrayLike], *, closed: bool = False) -> Mesh:
    """Return the surface that connects rings in their order along an axis.

    Args:
        rings: Shape (n, 3) each, counterclockwise seen from the end of the axis; a single point makes a tip.
        closed: Whether the last ring joins the first, so that the ends need no caps.
    """
    points = [np.asarray(ring, float) for ring in rings]
    if not closed:
        points = [*_cap(points[0]), *points, *_cap(points[-1])]
    counts = [len(ring) for ring in points]
    starts = [0, *accumulate(counts)]
    following = counts[1:] + counts[:1] if closed else counts[1:]
    faces = [start + _band(low, high) for start, low, high in zip(starts, counts, following, strict=False)]
    return Mesh(np.concatenate(points), np.concatenate(faces) % starts[-1])


def lathe(profile: Outline, at: Vec3 = ORIGIN, segments: int = ROUND, *, closed: bool = False) -> Mesh:
    """Return a surface of revolution about the z axis.

    Args:
        profile: Radius and height, along the outer side from the bottom up, and for a hollow back down the inner side.
        at: Position of the origin.
        segments: Corners of a circle.
        closed: Whether the profile returns to its start and leaves a hole around the axis.
    """
    return move(loft([_circle(radius, height, segments) for radius, height in profile], closed=closed), at)


def ring(radius: float, thickness: float, at: Vec3 = ORIGIN, segments: int = 24, corners: int = 10) -> Mesh:
    """Return a torus that lies flat, with the radius of its centre line and that of its tube (*thickness*)."""
    turn = math.tau * np.arange(corners) / corners - math.pi / 2
    circles = [_circle(radius + thickness * math.cos(a), thickness * math.sin(a), segments) for a in turn]
    return move(loft(circles, closed=True), at)


def egg(radii: Vec3, at: Vec3 = ORIGIN, segments: int = ROUND, rows: int = 8) -> Mesh:
    """Return an ellipsoid with three half axes."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, rows + 1)
    profile = [(math.cos(angle), math.sin(angle)) for angle in angles[1:-1]]
    return move(stretch(lathe([(0.0, -1.0), *profile, (0.0, 1.0)], segments=segments), radii), at)


def ball(radius: float, at: Vec3 = ORIGIN, segments: int = ROUND, rows: int = 8) -> Mesh:
    """Return a sphere."""
    return egg((radius, radius, radius), at, segments, rows)


def small_ball(radius: float, at: Vec3) -> Mesh:
    """Return a sphere with few faces, for small details such as eyes."""
    return ball(radius, at, segments=8, rows=4)


def box(size: Vec3, at: Vec3 = ORIGIN, bevel: float = 0.0) -> Mesh:
    """Return a box with three edge lengths and bevelled edges."""
    x, y, z = (length / 2 for length in size)
    if not bevel:
        return move(loft([_rectangle(x, y, -z), _rectangle(x, y, z)]), at)
    layers = [(bevel, -z), (0.0, bevel - z), (0.0, z - bevel), (bevel, z)]
    return move(loft([_rectangle(x - inset, y - inset, height, bevel / 2) for inset, height in layers]), at)


def frustum(bottom: tuple[float, float], top: tuple[float, float], height: float, at: Vec3, lean: float = 0.0) -> Mesh:
    """Return a box whose top differs from its bottom.

    Args:
        bottom: Edge lengths along x and y.
        top: Edge lengths along x and y.
        height: From bottom to top.
        at: Middle of the bottom.
        lean: Offset of the top along x.
    """
    upper = _rectangle(top[0] / 2, top[1] / 2, height) + np.array([lean, 0.0, 0.0])
    return move(loft([_rectangle(bottom[0] / 2, bottom[1] / 2, 0.0), upper]), at)


def plate(outline: Outline, low: float, high: float, bevel: float = 0.0) -> Mesh:
    """Return an extruded outline in x and y.

    Args:
        outline: Its corners.
        low: Height of its underside.
        high: Height of its upper side.
        bevel: Fraction by which its two faces are smaller than its middle.
    """
    corners = np.asarray(outline, float)
    inner = corners + bevel * (corners.mean(axis=0) - corners)
    depth = (high - low) / 4
    layers = [(inner, low), (corners, low + depth), (corners, high - depth), (inner, high)]
    return loft([_lift(xy, z) for xy, z in (layers if bevel else [(corners, low), (corners, high)])])


def board(outline: Outline, thickness: float, at: Vec3 = ORIGIN, bevel: float = 0.0) -> Mesh:
    """Return an outline in x and z, extruded along y; see `plate`."""
    return move(turn(plate(outline, -thickness / 2, thickness / 2, bevel), "x", 90), at)


def tube(path: npt.ArrayLike, radii: float | Sequence[float], segments: int = 10) -> Mesh:
    """Return a tube with rounded ends.

    Args:
        path: Its centre line, shape (n, 3), without sharp turns.
        radii: Its radius, constant or at each point.
        segments: Corners of a circle.
    """
    points = np.asarray(path, float)
    thickness = np.broadcast_to(np.asarray(radii, float), len(points))
    ahead = _unit(np.gradient(points, axis=0))
    frames = _frames(ahead)
    circle = _unit_circle(segments)[:, :2]
    stations = [(0, -1.0, 0.0), (0, -COS_45, COS_45)]
    stations += [(number, 0.0, 1.0) for number in range(len(points))]
    stations += [(-1, COS_45, COS_45), (-1, 1.0, 0.0)]
    return loft(
        [
            points[i]
            + thickness[i] * (along * ahead[i] + across * (circle @ frames[i] if across else np.zeros((1, 3))))
            for i, along, across in stations
        ]
    )


def rod(start: Vec3, end: Vec3, radius: float, segments: int = 10) -> Mesh:
    """Return a straight tube with rounded ends, which extend beyond its start and end."""
    return tube([start, end], radius, segments)


@cache
def _band(low_count: int, high_count: int) -> IntArray:
    """Return the faces between two rings, or between a ring and a point, whose corners are numbered consecutively."""
    count = max(low_count, high_count)
    here = np.arange(count)
    there = np.roll(here, -1)
    low, low_next = (here, there) if low_count > 1 else (0 * here, 0 * here)
    high, high_next = (low_count + here, low_count + there) if high_count > 1 else (0 * here + low_count,) * 2
    first, second = np.stack([low, low_next, high_next], axis=1), np.stack([low, high_next, high], axis=1)
    faces = [first] if high_count == 1 else [second] if low_count == 1 else [first, second]
    return np.concatenate(faces)


def _cap(end: FloatArray) -> list[FloatArray]:
    """Return the point that closes an end, unless the end is a point."""
    return [end.mean(axis=0, keepdims=True)] if len(end) > 1 else []


def _circle(radius: float, height: float, segments: int) -> FloatArray:
    """Return a ring about the z axis, or a point on it for a radius of zero."""
    return np.array([0.0, 0.0, height]) + radius * _unit_circle(segments)[: segments if radius else 1]


@cache
def _unit_circle(segments: int) -> FloatArray:
    angles = math.tau * np.arange(segments) / segments
    return np.column_stack([np.cos(angles), np.sin(angles), np.zeros(segments)])


def _rectangle(x: float, y: float, height: float, cut: float = 0.0) -> FloatArray:
    """Return a ring of four corners, or of eight if the corners are cut off."""
    if not cut:
        return np.array([[-x, -y, height], [x, -y, height], [x, y, height], [-x, y, height]])
    corners = [(cut - x, -y), (x - cut, -y), (x, cut - y), (x, y - cut)]
    return _lift(np.array([*corners, *((-a, -b) for a, b in corners)]), height)


def _lift(xy: FloatArray, height: float) -> FloatArray:
    """Return points in x and y as points in space at a height."""
    return np.column_stack([xy, np.full(len(xy), height)])


def _frames(ahead: FloatArray) -> list[FloatArray]:
    """Return two unit vectors perpendicular to each direction, shape (2, 3), with minimal twist along the path."""
    side = np.eye(3)[int(np.argmin(np.abs(ahead[0])))]
    frames = []
    for direction in ahead:
        side = _unit(side - (side @ direction) * direction)
        frames.append(np.stack([side, np.cross(direction, side)]))
    return frames


def _unit(vectors: FloatArray) -> FloatArray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
