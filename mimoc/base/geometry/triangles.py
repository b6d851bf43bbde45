"""Meshes of triangles."""

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray


def normals_of(verts_m: FloatArray, faces: npt.NDArray[np.intp]) -> FloatArray:
    """Return the direction away from a mesh at each vertex, shape (n, 3); 0 where it has no area.

    It is the mean of the normals of the triangles at the vertex, weighted by their areas.
    """
    a, b, c = (verts_m[faces[:, corner]] for corner in range(3))
    across = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    total = np.column_stack([np.bincount(faces.ravel(), across[:, axis], len(verts_m)) for axis in range(3)])
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)


def smoothed(values: FloatArray, faces: npt.NDArray[np.intp], rounds: int) -> FloatArray:
    """Return values (n, k) at the vertices of a mesh after each goes halfway to its neighbours' mean so often.

    The mesh is closed, its faces have shape (m, 3): two that share an edge name its ends in opposite orders.
    """
    here, beside = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    count = np.maximum(np.bincount(here, minlength=len(values)), 1)
    columns = values.T
    for _ in range(rounds):
        means = [np.bincount(here, column[beside], len(column)) / count for column in columns]
        columns = (columns + np.array(means)) / 2
    return columns.T
