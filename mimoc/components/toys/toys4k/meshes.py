"""Cleaning of a triangle mesh, and its approximate decomposition into convex parts, for collisions.

A clean mesh has finite coordinates, unit size, and no duplicate or degenerate triangles. Faces are wound so that they
face outwards, and decimation reduces their number.
"""

import io
import math
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import ToyError
from mimoc.base.geometry.rotations import matrix_from_axis, quaternion_from_matrix
from mimoc.compiler.toys import FloatArray, IntArray, Mesh, Solid, join
from mimoc.components.toys.toys4k.worker import WorkerError, WorkerTimeoutError, run_worker

GRID = 2**20 - 1  # Grid steps along the longest side; vertices in the same step are merged. As fine as 32-bit floats.
MIN_SIZE = 1e-9
"""Smallest ratio of the longest side to the distance from the origin: below it, only rounding errors are left."""
MIN_AREA = 1e-13  # Smallest area of a triangle, relative to the square of the longest side.


def clean(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a cleaned mesh with its lower corner at the origin, whose longest side is 1.

    Vertices are of any scale and may contain values that are not finite. Raises `ToyError` if no triangle is left.
    """
    finite = np.logical_and.reduce(np.isfinite(vertices), axis=1)
    mesh = only_used(vertices, faces[finite[faces].all(axis=1)])
    if not len(mesh.faces):
        raise ToyError("has no triangle whose vertices are all finite numbers")
    mesh = tidy(merge(Mesh(_unit(mesh.vertices), mesh.faces)))
    if not len(mesh.faces):
        raise ToyError("has no surface: each of its triangles is a line or a point")
    return Mesh(_unit(mesh.vertices), mesh.faces)


def merge(mesh: Mesh) -> Mesh:
    """Return a mesh of unit size with coincident vertices merged."""
    x, y, z = np.round(mesh.vertices * GRID).astype(np.int64).T
    _, first, place = np.unique((x << 40) | (y << 20) | z, return_index=True, return_inverse=True)
    return Mesh(mesh.vertices[first], place[mesh.faces])


def tidy(mesh: Mesh) -> Mesh:
    """Return a mesh without degenerate or duplicate triangles, and without unused vertices."""
    from trimesh.grouping import unique_rows

    faces = mesh.faces[_areas(mesh) > MIN_AREA]
    first, _ = unique_rows(np.sort(faces, axis=1))
    return only_used(mesh.vertices, faces[np.sort(first)])


def only_used(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a mesh without unused vertices."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return Mesh(vertices[used], (np.cumsum(used) - 1)[faces])


def _areas(mesh: Mesh) -> npt.NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _unit(vertices: FloatArray) -> FloatArray:
    """Return vertices scaled to a longest side of 1, with the lower corner at the origin, without overflow."""
    reach = np.abs(vertices).max()
    shrunk = vertices / reach if reach else vertices
    low = shrunk.min(axis=0)
    size = (shrunk.max(axis=0) - low).max()
    if size < MIN_SIZE:
        raise ToyError("has all its vertices at the same point")
    return (shrunk - low) / size


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A mesh and its shells, which are connected at edges of two triangles."""

    mesh: Mesh
    shells: IntArray  # Index of the shell of each face.
    closed: npt.NDArray[np.bool_]  # Whether the shell of each face is closed: all of its edges have two faces.


def face_outwards(mesh: Mesh) -> Surface:
    """Return a mesh in which the faces of each shell are wound consistently, so that its volume is positive."""
    from trimesh.graph import connected_component_labels
    from trimesh.grouping import group_rows

    count = len(mesh.faces)
    starts = mesh.faces.ravel()
    ends = np.roll(mesh.faces, -1, axis=1).ravel()
    keys = np.minimum(starts, ends) * len(mesh.vertices) + np.maximum(starts, ends)
    edges = np.unique(keys, return_inverse=True)[1]
    pairs = np.asarray(group_rows(edges, require_count=2))
    a, b = pairs.T // 3
    same = np.equal(*(starts < ends)[pairs].T).astype(np.intp)
    links = np.concatenate([np.stack([a, b + count * same], 1), np.stack([a + count, b + count * (1 - same)], 1)])
    labels = np.asarray(connected_component_labels(links, node_count=2 * count)).reshape(2, count)
    _, shells = np.unique(labels.min(axis=0), return_inverse=True)
    faces = _flipped(mesh.faces, labels[0] > labels[1])
    faces = _flipped(faces, (_volumes(mesh.vertices, faces, shells) < 0)[shells])
    shell_of_edge = np.repeat(shells, 3)
    is_border = np.ones(3 * count, bool)
    is_border[group_rows(shell_of_edge * len(edges) + edges, require_count=2)] = False
    open_shells = np.union1d(shells[labels[0] == labels[1]], shell_of_edge[is_border])
    return Surface(Mesh(mesh.vertices, faces), shells, ~np.isin(shells, open_shells))


def from_both_sides(mesh: Mesh) -> Mesh:
    """Return a mesh joined with a copy wound the other way, since MuJoCo renders triangles from the front only."""
    return join([mesh, Mesh(mesh.vertices, mesh.faces[:, ::-1])])


def _flipped(faces: IntArray, wrong: npt.NDArray[np.bool_]) -> IntArray:
    return np.where(wrong[:, None], faces[:, ::-1], faces)


def _volumes(vertices: FloatArray, faces: IntArray, shells: IntArray) -> FloatArray:
    """Return the volume of each shell; an open shell is closed by joining its border to its middle."""
    corners = vertices[faces]
    sizes = np.bincount(shells)
    middles = np.stack([np.bincount(shells, corners[..., axis].mean(axis=1)) / sizes for axis in range(3)], axis=1)
    a, b, c = np.moveaxis(corners - middles[shells][:, None], 1, 0)
    return np.bincount(shells, np.einsum("ij,ij->i", np.cross(a, b), c) / 6).astype(float)


LARGE = 100_000  # Number of faces above which close vertices are merged before edges are collapsed.
FINE = (256, 128, 96, 64)  # Grid cells along the longest side; vertices in the same cell are merged.
COARSENESS = (0.75, 12)
"""Factor on the number of cells from one attempt at clustering to the next, and number of attempts."""


def has_simplifier() -> bool:
    """Return whether fast_simplification (quadric decimation) is installed; without it, close vertices are merged."""
    return find_spec("fast_simplification") is not None


def decimate(mesh: Mesh, most_faces: int) -> Mesh:
    """Return a mesh, whose longest side is at most 1, with at least one and at most the given number of faces."""
    if len(mesh.faces) <= most_faces:
        return mesh
    simple = _collapsed(mesh, most_faces) if has_simplifier() else _clustered(mesh, most_faces)
    good = 0 < len(simple.faces) <= most_faces and np.isfinite(simple.vertices).all()
    return simple if good else _clustered(mesh, most_faces)


def _collapsed(mesh: Mesh, most_faces: int) -> Mesh:
    """Collapse the edges that change the shape least; if that gets stuck, merge close vertices first."""
    from fast_simplification import simplify

    simple = mesh if len(mesh.faces) <= LARGE else _joined(mesh, FINE[0])
    for cells in FINE[1:]:
        if len(simple.faces) > most_faces:
            arrays = np.array(simple.vertices, order="C"), np.array(simple.faces, np.int32, order="C")
            vertices, faces = simplify(*arrays, target_count=most_faces)[:2]
            simple = tidy(Mesh(np.asarray(vertices, float), np.asarray(faces, np.intp)))
        if len(simple.faces) <= most_faces:
            break
        simple = _joined(mesh, cells)
    return simple


def _clustered(mesh: Mesh, most_faces: int) -> Mesh:
    """Merge all vertices in each cell of a grid, with larger and larger cells until there are few enough faces.

    A surface crosses about 6 n² of n³ cells, with two faces each. If no surface is left before that (as with many
    small, unconnected faces), the largest faces are kept.
    """
    factor, tries = COARSENESS
    cells = (most_faces / 2) ** 0.5
    for _ in range(tries):
        simple = _joined(mesh, cells)
        if 0 < len(simple.faces) <= most_faces:
            return simple
        cells *= factor
    kept = np.sort(np.argsort(-_areas(mesh), kind="stable")[:most_faces])
    return only_used(mesh.vertices, mesh.faces[kept])


def _joined(mesh: Mesh, cells: float) -> Mesh:
    """Return a mesh in which the vertices in each cell of a grid are replaced by their mean."""
    x, y, z = np.floor((mesh.vertices - mesh.vertices.min(axis=0)) * cells).astype(np.int64).T
    _, place, counts = np.unique((x << 40) | (y << 20) | z, return_inverse=True, return_counts=True)
    sums = [np.bincount(place, mesh.vertices[:, axis]) for axis in range(3)]
    faces = place[mesh.faces]
    a, b, c = faces.T
    return tidy(Mesh(np.stack(sums, axis=1) / counts[:, None], faces[(a != b) & (b != c) & (c != a)]))


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
    vertices = np.asarray(around.vertices, float)
    faces = np.asarray(around.faces, np.intp)
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
