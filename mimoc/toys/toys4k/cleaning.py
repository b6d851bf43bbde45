"""Cleaning of a triangle mesh: finite coordinates, unit size, no duplicate or degenerate triangles."""

import numpy as np
import numpy.typing as npt

from mimoc.errors import ToyError
from mimoc.toys.model import FloatArray, IntArray, Mesh

GRID = 2**20 - 1
"""Grid steps along the longest side; vertices in the same step are merged. As fine as 32-bit floats."""
LEAST_SIZE = 1e-9
"""Smallest ratio of the longest side to the distance from the origin: below it, only rounding errors are left."""
LEAST_AREA = 1e-13
"""Smallest area of a triangle, relative to the square of the longest side."""


def clean(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a cleaned mesh with its lower corner at the origin, whose longest side is 1.

    Args:
        vertices: Shape (n, 3), of any scale; may contain values that are not finite.
        faces: Shape (m, 3), valid indices of vertices.

    Raises:
        ToyError: If no triangle is left.
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
    faces = mesh.faces[_areas(mesh) > LEAST_AREA]
    ordered = np.sort(faces, axis=1)
    order = np.lexsort(ordered.T)
    repeats = (np.diff(ordered[order], axis=0) == 0).all(axis=1)
    first = np.sort(order[np.concatenate([np.ones(min(len(faces), 1), bool), ~repeats])])
    return only_used(mesh.vertices, faces[first])


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
    if size < LEAST_SIZE:
        raise ToyError("has all its vertices at the same point")
    return (shrunk - low) / size
