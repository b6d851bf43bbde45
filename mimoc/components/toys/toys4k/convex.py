"""Approximate decomposition of a mesh into convex parts, for collisions."""

import io
import math
from importlib.util import find_spec

import numpy as np

from mimoc.base.errors import ToyError
from mimoc.base.geometry.rotations import FloatArray, matrix_from_axis, quaternion_from_matrix
from mimoc.compiler.toys.shape import IntArray, Mesh, Solid
from mimoc.components.toys.toys4k.subprocesses import WorkerError, WorkerTimeoutError, run_worker

MAX_PARTS = 10
MAX_CORNERS = 64  # Maximum number of vertices of a part.
MAX_FACES = 2000  # Maximum number of faces of a mesh that is passed to coacd.
LIMIT_S = 30  # Limit on coacd's CPU time: it needs 1 s to 10 s.
COVER = 0.1  # Largest difference between the bounding boxes of all parts and of the mesh, whose longest side is 1.
THIN = 0.01
"""Smallest thickness, relative to the longest side: a thinner mesh gets a box of this thickness, because its convex
hull would be dominated by rounding errors or degenerate."""
MIN_VOLUME = 1e-6  # Smallest volume of a part of a mesh whose longest side is 1: MuJoCo rejects meshes of 1e-15 m³.

_CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_FACES: IntArray = np.array([corners for a, b, c, d in _SIDES for corners in ((a, b, c), (a, c, d))])
"""Faces of a box with those corners."""


def has_coacd() -> bool:
    """Return whether coacd is installed, which decomposes meshes; without it, each mesh gets its convex hull."""
    return find_spec("coacd") is not None


def convex_parts(mesh: Mesh, *, simple: bool) -> list[Mesh]:
    """Return convex meshes: the same on every machine, or none at all.

    Args:
        mesh: Mesh of at most `MAX_FACES` faces, whose longest side is 1, and which is not flat.
        simple: Whether it is one closed shell; any other mesh is first converted to one, which rounds its edges.

    Raises:
        ToyError: If it takes too long; the message is a predicate without its subject, the mesh.
    """
    whole = [hull(mesh.vertices)]
    if not has_coacd():
        return whole
    content = io.BytesIO()
    np.savez(content, vertices=mesh.vertices, faces=mesh.faces)
    preprocessing = "auto" if simple else "on"
    try:
        result = run_worker("decompose", content.getvalue(), preprocessing, MAX_PARTS, MAX_CORNERS, limit_s=LIMIT_S)
    except WorkerTimeoutError as error:
        raise ToyError(f"{error} into convex parts; give it fewer and larger surfaces") from None
    except WorkerError:
        return whole
    corners = np.split(result["corners"], np.cumsum(result["counts"])[:-1])
    parts = [hull(points) for points in corners if np.isfinite(points).all() and not is_thin(points, THIN / 10)]
    parts = [part for part in parts if part.volume > MIN_VOLUME]
    return parts if len(parts) <= MAX_PARTS and _reaches_as_far(parts, mesh) else whole


def _reaches_as_far(parts: list[Mesh], mesh: Mesh) -> bool:
    if not parts:
        return False
    corners = np.concatenate([part.vertices for part in parts])
    low, high = corners.min(axis=0) - mesh.vertices.min(axis=0), corners.max(axis=0) - mesh.vertices.max(axis=0)
    return bool(max(np.abs(low).max(), np.abs(high).max()) < COVER)


def hull(points: FloatArray, most_corners: int = MAX_CORNERS) -> Mesh:
    """Return the convex hull of points that are not coplanar; if it has too many vertices, of the outermost ones."""
    around = _hull(points)
    return around if len(around.vertices) <= most_corners else _hull(_furthest(around.vertices, most_corners))


def is_thin(points: FloatArray, thickness: float = THIN) -> bool:
    """Return whether points lie nearly in a plane or on a line."""
    return len(points) < 4 or np.ptp(points @ _axes(points), axis=0).min() < thickness


def thin_box(points: FloatArray) -> Mesh:
    """Return the smallest box around thin points, with a minimum thickness, as a mesh; see `box_of`."""
    axes = _axes(points)
    boxes = [axes @ matrix_from_axis((0.0, 0.0, 1.0), math.radians(degrees)) for degrees in range(90)]
    box_axes = min(boxes, key=lambda box: math.prod(np.maximum(np.ptp(points @ box[:, :2], axis=0), THIN)))
    low, high = (points @ box_axes).min(axis=0), (points @ box_axes).max(axis=0)
    corners = (low + high) / 2 + _CORNERS * np.maximum(high - low, THIN) / 2
    return Mesh(corners @ box_axes.T, _FACES)


def box_of(mesh: Mesh) -> Solid:
    """Return the box solid of a mesh from `thin_box`, which may have been moved, rotated and scaled."""
    edges = mesh.vertices[[4, 2, 1]] - mesh.vertices[0]
    lengths = np.linalg.norm(edges, axis=1)
    quat = quaternion_from_matrix((edges / lengths[:, None]).T)
    half_x, half_y, half_z = (lengths / 2).tolist()
    at_x, at_y, at_z = mesh.vertices.mean(axis=0).tolist()
    return Solid("box", (half_x, half_y, half_z), (at_x, at_y, at_z), quat)


def _hull(points: FloatArray) -> Mesh:
    from trimesh.convex import convex_hull

    around = convex_hull(points, repair=False)  # Repairing requires networkx, which may not be installed.
    vertices, faces = np.asarray(around.vertices, float), np.asarray(around.faces, np.intp)
    a, b, c = (vertices[faces[:, corner]] - vertices.mean(axis=0) for corner in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(a, b), c) < 0
    return Mesh(vertices, np.where(inwards[:, None], faces[:, ::-1], faces))


def _furthest(points: FloatArray, most: int) -> FloatArray:
    """Return at most the given number of points, each the extreme point in some direction."""
    even = np.arange(most - 6) + 0.5
    height, angle = 1 - 2 * even / len(even), even * math.pi * (1 + 5**0.5)  # Fibonacci's spiral on a sphere.
    width = np.sqrt(1 - height**2)
    around = np.stack([width * np.cos(angle), width * np.sin(angle), height], axis=1)
    directions = np.concatenate([np.eye(3), -np.eye(3), around])
    scaled = points / np.maximum(np.ptp(points, axis=0), THIN / 10)
    return points[np.unique((scaled @ directions.T).argmax(axis=0))]


def _axes(points: FloatArray) -> FloatArray:
    middle = points - points.mean(axis=0)
    axes = np.linalg.eigh(middle.T @ middle)[1][:, ::-1]
    return axes * np.sign(np.linalg.det(axes))
