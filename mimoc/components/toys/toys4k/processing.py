"""Processing of a mesh file into the shape of a toy, which rests on a stable side, with its top upwards if possible."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import ToyError
from mimoc.base.geometry.rotations import FloatArray, matrix_from_quaternion, quaternion_between
from mimoc.compiler.toys import Mesh, Solid, centre_of, join
from mimoc.components.toys.toys4k.meshes import (
    MAX_FACES,
    MAX_PARTS,
    Surface,
    box_of,
    clean,
    convex_parts,
    decimate,
    face_outwards,
    from_both_sides,
    hull,
    is_thin,
    only_used,
    thin_box,
)
from mimoc.components.toys.toys4k.worker import WorkerError, run_worker

STEADY_DEG = 5.0  # Smallest angle at which an object tips over for a pose to count as stable.
NEAR_DEG = 20.0  # Largest rotation from the upright pose of the file to a pose on its nearest side.
FLAT_DEG = 2.0  # Sides whose normals differ by less count as one: the difference is due to rounding.
TOPS = {"obj": "y", "glb": "y", "ply": "z", "stl": "z"}
"""Up axis by file format: glTF requires y and Blender writes it to .obj by default; to .ply and .stl it writes z."""
_UPRIGHT: dict[str, FloatArray] = {"y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), "z": np.eye(3)}
"""Rotation that makes an axis point up."""
VERSION = 3  # Version of the processing, incremented with each change of its results.
MAX_FACES_SEEN = 5000  # Most faces of the mesh that is seen.
MAX_FACES_READ = 4_000_000  # Most faces of a file that is read.
READING_LIMIT_S = 90
MAX_SHELLS, MIN_FACES = 100, 8
"""A mesh of more shells with fewer faces each on average is a soup of triangles, on which coacd takes minutes: only its
hull is used."""
MIN_FILLED = 0.05
"""Smallest volume of a closed mesh, relative to that of its convex parts: below it, the mesh is a thin shell."""


def set_down(normals: FloatArray, distances: FloatArray, top: str) -> FloatArray:
    """Return the rotation that places an object on one of its sides, shape (3, 3).

    The side is a stable one near the bottom of the object, first with the format's up axis pointing up, then with the
    other one; if there is none, it is the most stable side, with a preference for lower ones.

    Args:
        normals: Outward normals of the faces of its convex hull, shape (n, 3).
        distances: Distances of those faces from its centre of mass, shape (n,).
        top: The format's up axis, y or z.
    """
    lean_deg = _lean_deg(normals, distances)
    for axis in sorted(_UPRIGHT, key=lambda axis: axis != top):
        upright = _UPRIGHT[axis]
        tilt_deg = np.degrees(np.arccos(np.clip(normals @ -upright[2], -1, 1)))
        candidates = np.flatnonzero((tilt_deg < NEAR_DEG) & (lean_deg > STEADY_DEG))
        if candidates.size:
            side = candidates[np.argmin(tilt_deg[candidates].round(1) - lean_deg[candidates] / 1000)]
            return _turn_down(upright @ normals[side]) @ upright
    upright = _UPRIGHT[top]
    side = np.argmax(lean_deg * (1.5 - normals @ upright[2]))
    return _turn_down(upright @ normals[side]) @ upright


def planes(vertices: FloatArray, faces: npt.NDArray[np.intp], centre: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the outward normals of the faces of a convex mesh and their distances from a point, without slivers."""
    a, b, c = (vertices[faces[:, corner]] - centre for corner in range(3))
    cross = np.cross(b - a, c - a)
    lengths = np.linalg.norm(cross, axis=1)
    real = lengths > lengths.max() * 1e-6
    normals = cross[real] / lengths[real, None]
    return normals, np.einsum("ij,ij->i", normals, a[real])


def _lean_deg(normals: FloatArray, distances: FloatArray) -> FloatArray:
    """Return the angle at which an object on each of its sides tips over; negative for a side that is unstable.

    The point below the centre of mass, in the plane of a side, is `-distance * normal`. The nearest edge is where
    another plane intersects this one.
    """
    lean_deg = np.empty(len(normals))
    for side, (normal, distance) in enumerate(zip(normals, distances, strict=True)):
        along = normals @ normal
        edges = along < np.cos(np.radians(FLAT_DEG))
        room = (distances[edges] - distance * along[edges]) / np.sqrt(np.maximum(1 - along[edges] ** 2, 1e-12))
        opposite = along[edges] < -1 + 1e-9
        lean_deg[side] = np.degrees(np.arctan2(room[~opposite].min(), max(distance, 1e-9)))
    return lean_deg


def _turn_down(normal: FloatArray) -> FloatArray:
    return matrix_from_quaternion(quaternion_between(normal, np.array([0.0, 0.0, -1.0])))


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """The result of processing a mesh file. Lengths are in units of the longest side."""

    looks: Mesh
    solids: tuple[Solid, ...]
    volume: float
    has_holes: bool = False  # Whether it has shells that are not closed, so that these collide as their convex hull.


def process(content: bytes, kind: str) -> Shape:
    """Return the shape of a toy from a mesh file of a format in `mimoc.components.toys.toys4k.dataset.FORMATS`.

    It stands on z = 0 in its most stable upright pose, centred over the origin.

    Raises:
        ToyError: If it cannot be used; the message is a predicate without its subject, the mesh.
    """
    try:
        arrays = run_worker("read", content, kind, MAX_FACES_READ, limit_s=READING_LIMIT_S)
    except WorkerError as error:
        raise ToyError(str(error)) from None
    surface = face_outwards(clean(arrays["vertices"], arrays["faces"]))
    is_closed = bool(surface.closed.all())
    one_sided, looks = _looks(surface)
    is_flat = is_thin(looks.vertices)
    if is_flat:
        parts = [thin_box(looks.vertices)]
    elif _is_soup(surface):
        parts = [hull(decimate(one_sided, MAX_FACES).vertices)]
    elif is_closed:
        parts = convex_parts(decimate(one_sided, MAX_FACES), simple=not surface.shells.any())
    else:
        parts = _parts_with_holes(surface)
    volume = _volume(surface.mesh if is_closed else None, parts)
    rotation = _rotation(parts, TOPS[kind])
    low, high = np.min(looks.vertices @ rotation.T, axis=0), np.max(looks.vertices @ rotation.T, axis=0)
    scale = 1 / float((high - low).max())
    middle = (low + high) / 2
    ground = min(float((part.vertices @ rotation[2]).min()) for part in parts)
    placed = [_placed(part, rotation, np.array([middle[0], middle[1], ground]), scale) for part in parts]
    return Shape(
        looks=_placed(looks, rotation, np.array([middle[0], middle[1], low[2]]), scale),
        solids=tuple(box_of(part) if is_flat else Solid("mesh", (), mesh=part) for part in placed),
        volume=volume * scale**3,
        has_holes=not (is_closed or is_flat),
    )


def _is_soup(surface: Surface) -> bool:
    """Return whether a mesh is a soup of triangles: many shells with few faces each."""
    shells = surface.shells.max() + 1
    return bool(shells > MAX_SHELLS and len(surface.mesh.faces) < MIN_FACES * shells)


def _parts_with_holes(surface: Surface) -> list[Mesh]:
    """Return the convex hull of all shells with holes, and convex parts of the closed ones.

    A surface with holes has no inside, so that coacd would take minutes to divide the two sides of its wall.
    """
    mesh = surface.mesh
    closed = surface.closed
    torn, whole = (decimate(only_used(mesh.vertices, mesh.faces[which]), MAX_FACES) for which in (~closed, closed))
    parts = [thin_box(torn.vertices) if is_thin(torn.vertices) else hull(torn.vertices)]
    if len(whole.faces) and not is_thin(whole.vertices):
        parts += convex_parts(whole, simple=len(np.unique(surface.shells[closed])) == 1)
    elif len(whole.faces):
        parts.append(thin_box(whole.vertices))
    return parts if len(parts) <= MAX_PARTS else [hull(np.concatenate([torn.vertices, whole.vertices]))]


def _looks(surface: Surface) -> tuple[Mesh, Mesh]:
    """Return a decimated mesh, and a copy of it whose open shells are visible from both sides."""
    mesh = surface.mesh
    whole, torn = (only_used(mesh.vertices, mesh.faces[which]) for which in (surface.closed, ~surface.closed))
    share = MAX_FACES_SEEN / max(len(whole.faces) + 2 * len(torn.faces), MAX_FACES_SEEN)
    whole, torn = (decimate(part, max(int(len(part.faces) * share), 1)) for part in (whole, torn))
    return join([whole, torn]), join([whole, from_both_sides(torn)])


def _volume(closed: Mesh | None, parts: Sequence[Mesh]) -> float:
    """Return the volume of a closed mesh, or of its convex parts if the mesh is open, a thin shell or overlapping."""
    of_parts = math.fsum(part.volume for part in parts)
    within = closed.volume if closed else 0.0
    return min(within, of_parts) if within >= MIN_FILLED * of_parts else of_parts


def _rotation(parts: Sequence[Mesh], top: str) -> FloatArray:
    """Return the rotation that places parts of equal density on a face of their common convex hull."""
    weights = np.array([part.volume for part in parts])
    centre = weights @ np.stack([centre_of(part) for part in parts]) / weights.sum()
    corners = np.concatenate([part.vertices for part in parts])
    around = parts[0] if len(parts) == 1 else hull(corners, len(corners))
    return set_down(*planes(around.vertices, around.faces, centre), top)


def _placed(mesh: Mesh, rotation: FloatArray, origin: FloatArray, scale: float) -> Mesh:
    return Mesh((mesh.vertices @ rotation.T - origin) * scale, mesh.faces)
