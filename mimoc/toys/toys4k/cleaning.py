"""From any triangles to the surface they make: finite, of unit size, each corner and each triangle once."""

import numpy as np
import numpy.typing as npt

from mimoc.errors import ToyError
from mimoc.toys.model import FloatArray, IntArray, Mesh

GRID = 2**20 - 1
"""Steps along the longest side; corners in one step are the same. As fine as 32-bit floats are."""
LEAST_SIZE = 1e-9
"""Longest side, of the distance from the origin: less, and rounding is all that is left."""
LEAST_AREA = 1e-13
"""Of a triangle, of the square of the longest side."""


def clean(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a mesh from (0, 0, 0), whose longest side is 1.

    Args:
        vertices: Shape (n, 3), of any size, and not always finite.
        faces: Shape (m, 3), all of whose corners are there.

    Raises:
        ToyError: If nothing is left.
    """
    finite = np.logical_and.reduce(np.isfinite(vertices), axis=1)
    mesh = only_used(vertices, faces[finite[faces].all(axis=1)])
    if not len(mesh.faces):
        raise ToyError("has no triangle whose corners are all finite numbers")
    mesh = tidy(merge(Mesh(_unit(mesh.vertices), mesh.faces)))
    if not len(mesh.faces):
        raise ToyError("has no surface: each of its triangles is a line or a point")
    return Mesh(_unit(mesh.vertices), mesh.faces)


def merge(mesh: Mesh) -> Mesh:
    """Return a mesh from (0, 0, 0) to 1 without corners that lie on one another."""
    x, y, z = np.round(mesh.vertices * GRID).astype(np.int64).T
    _, first, place = np.unique((x << 40) | (y << 20) | z, return_index=True, return_inverse=True)
    return Mesh(mesh.vertices[first], place[mesh.faces])


def tidy(mesh: Mesh) -> Mesh:
    """Return a mesh without triangles that have no area, that repeat another one, or corners of none."""
    faces = mesh.faces[_areas(mesh) > LEAST_AREA]
    ordered = np.sort(faces, axis=1)
    order = np.lexsort(ordered.T)
    repeats = (np.diff(ordered[order], axis=0) == 0).all(axis=1)
    first = np.sort(order[np.concatenate([np.ones(min(len(faces), 1), bool), ~repeats])])
    return only_used(mesh.vertices, faces[first])


def only_used(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a mesh without vertices that are the corner of nothing."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return Mesh(vertices[used], (np.cumsum(used) - 1)[faces])


def _areas(mesh: Mesh) -> npt.NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _unit(vertices: FloatArray) -> FloatArray:
    """Return vertices from (0, 0, 0), whose longest side is 1; the largest of floats are divided, never added."""
    reach = np.abs(vertices).max()
    shrunk = vertices / reach if reach else vertices
    low = shrunk.min(axis=0)
    size = (shrunk.max(axis=0) - low).max()
    if size < LEAST_SIZE:
        raise ToyError("has all its corners in one place")
    return (shrunk - low) / size
