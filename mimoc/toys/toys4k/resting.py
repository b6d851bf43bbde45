"""Resting pose of an object: on a stable side, with its top upwards if possible."""

import numpy as np
import numpy.typing as npt

from mimoc.geometry.rotations import FloatArray, matrix_from_quaternion, quaternion_between

STEADY_DEG = 5.0
"""Smallest angle at which an object tips over for a pose to count as stable."""
NEAR_DEG = 20.0
"""Largest rotation from the upright pose of the file to a pose on its nearest side."""
FLAT_DEG = 2.0
"""Sides whose normals differ by less count as one: the difference is due to rounding."""
TOPS = {"obj": "y", "glb": "y", "ply": "z", "stl": "z"}
"""Up axis by file format: glTF requires y and Blender writes it to .obj by default; to .ply and .stl it writes z."""
_UPRIGHT: dict[str, FloatArray] = {"y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), "z": np.eye(3)}
"""Rotation that makes an axis point up."""


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
        fit = np.flatnonzero((tilt_deg < NEAR_DEG) & (lean_deg > STEADY_DEG))
        if fit.size:
            side = fit[np.argmin(tilt_deg[fit].round(1) - lean_deg[fit] / 1000)]
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
    """Return the smallest rotation that makes a direction point down."""
    return matrix_from_quaternion(quaternion_between(normal, np.array([0.0, 0.0, -1.0])))
