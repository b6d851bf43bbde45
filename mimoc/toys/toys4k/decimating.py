"""Decimation: reducing the number of triangles of a mesh."""

from importlib.util import find_spec

import numpy as np

from mimoc.toys.model import Mesh
from mimoc.toys.toys4k.cleaning import only_used, tidy

LARGE = 100_000
"""Number of faces above which close vertices are merged before edges are collapsed."""
FINE = (256, 128, 96, 64)
"""Grid cells along the longest side; vertices in the same cell are merged."""
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
    return _largest(mesh, most_faces)


def _joined(mesh: Mesh, cells: float) -> Mesh:
    """Return a mesh in which the vertices in each cell of a grid are replaced by their mean."""
    x, y, z = np.floor((mesh.vertices - mesh.vertices.min(axis=0)) * cells).astype(np.int64).T
    _, place, counts = np.unique((x << 40) | (y << 20) | z, return_inverse=True, return_counts=True)
    sums = [np.bincount(place, mesh.vertices[:, axis]) for axis in range(3)]
    faces = place[mesh.faces]
    a, b, c = faces.T
    return tidy(Mesh(np.stack(sums, axis=1) / counts[:, None], faces[(a != b) & (b != c) & (c != a)]))


def _largest(mesh: Mesh, most_faces: int) -> Mesh:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    kept = np.sort(np.argsort(-areas, kind="stable")[:most_faces])
    return only_used(mesh.vertices, mesh.faces[kept])
