"""Meshes of triangles: normals, smoothing, and the grid on which a face goes from one expression to another."""

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


STEP_M = 2.0**-17
"""Distance of the grid's points, 7.6 micrometres: fine enough for a face, and sums of such numbers are exact in single
precision."""

Steps = npt.NDArray[np.int16]


def on_grid(verts_m: FloatArray) -> FloatArray:
    """Return the points of the grid nearest to some vertices, shape (n, 3), [m].

    Example:
        >>> import numpy as np
        >>> from mimoc.base.geometry.meshes import STEP_M, on_grid
        >>> float(on_grid(np.array([[0.1, 0.0, 0.0]]))[0, 0] / STEP_M)
        13107.0
    """
    return np.rint(verts_m / STEP_M) * STEP_M


def steps_between(verts_m: FloatArray, others_m: FloatArray) -> Steps:
    """Return the steps from vertices to others, shape (n, 3)."""
    return np.rint((on_grid(others_m) - on_grid(verts_m)) / STEP_M).astype(np.int16)


def stepped(verts_m: FloatArray, before: Steps | None, after: Steps | None) -> FloatArray:
    """Return vertices of a face that goes from one expression to another, on the grid, shape (n, 3), [m].

    Args:
        verts_m: The vertices now.
        before: Steps from the neutral face to the present one; None if that is neutral.
        after: Steps from the neutral face to the next one; None if that is neutral.

    Example:
        >>> import numpy as np
        >>> from mimoc.base.geometry.meshes import STEP_M, stepped
        >>> smile = np.array([[0, 0, 8]], np.int16)
        >>> happy = stepped(np.zeros((1, 3)), None, smile)
        >>> (happy / STEP_M).tolist(), stepped(happy, smile, None).tolist()
        ([[0.0, 0.0, 8.0]], [[0.0, 0.0, 0.0]])
    """
    steps: FloatArray = np.rint(np.asarray(verts_m, np.float64) / STEP_M)
    for change, sign in ((before, -1.0), (after, 1.0)):
        if change is not None:
            steps = steps + sign * change.astype(np.float64)
    return steps * STEP_M
