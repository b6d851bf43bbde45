"""How a thing is set down: on a side that it stays on, its top upwards where that can be."""

import numpy as np
import numpy.typing as npt

from mimoc.geometry.rotations import FloatArray, matrix_from_quaternion, quaternion_between

STEADY_DEG = 5.0
"""How far a thing must lean before it falls for a pose to be called steady."""
NEAR_DEG = 20.0
"""How far a thing may be turned to stand on its nearest side."""
FLAT_DEG = 2.0
"""Sides that differ by less are one: the rest is rounding."""
TOPS = {"obj": "y", "glb": "y", "ply": "z", "stl": "z"}
"""Which axis points up: glTF demands y and Blender writes it to .obj by default; to .ply and .stl it writes z."""
_UPRIGHT: dict[str, FloatArray] = {"y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), "z": np.eye(3)}
"""What turns an axis up."""


def set_down(normals: FloatArray, distances: FloatArray, top: str) -> FloatArray:
    """Return the rotation that sets a thing down on one of its sides, shape (3, 3).

    It is a steady side near what is the bottom if the axis that points up by the format does, or else another one
    does; or else the steadiest side there is, the lower ones preferred.

    Args:
        normals: Outward, of the planes of its convex hull, shape (n, 3).
        distances: Of those planes from its centre of mass, shape (n,).
        top: The axis that should point up: y or z.
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
    """Return the outward normals and distances from a point of the faces of a convex mesh, but for slivers."""
    a, b, c = (vertices[faces[:, corner]] - centre for corner in range(3))
    cross = np.cross(b - a, c - a)
    lengths = np.linalg.norm(cross, axis=1)
    real = lengths > lengths.max() * 1e-6
    normals = cross[real] / lengths[real, None]
    return normals, np.einsum("ij,ij->i", normals, a[real])


def _lean_deg(normals: FloatArray, distances: FloatArray) -> FloatArray:
    """Return how far a thing on each of its sides can lean before it falls; negative where it falls at once.

    Below the centre of mass, in the plane of a side, is the point `-distance * normal`. The nearest edge is where
    another plane cuts this one.
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
