"""Fewer triangles for the same surface."""

from importlib.util import find_spec

import numpy as np

from mimoc.toys.model import Mesh
from mimoc.toys.toys4k.cleaning import only_used, tidy

LARGE = 100_000
"""Faces above which corners that are very close are joined before edges collapse."""
FINE = (256, 128, 96, 64)
"""Cells along the longest side: corners in one are close."""
COARSENESS = (0.75, 12)
"""Each try to cluster has so many times the cells of the one before, and there are so many tries."""


def has_simplifier() -> bool:
    """Tell whether quadric decimation is to be had; without it, corners near one another are joined."""
    return find_spec("fast_simplification") is not None


def decimate(mesh: Mesh, most_faces: int) -> Mesh:
    """Return a mesh of a longest side of at most 1 with no more than some faces, and at least one."""
    if len(mesh.faces) <= most_faces:
        return mesh
    simple = _collapsed(mesh, most_faces) if has_simplifier() else _clustered(mesh, most_faces)
    good = 0 < len(simple.faces) <= most_faces and np.isfinite(simple.vertices).all()
    return simple if good else _clustered(mesh, most_faces)


def _collapsed(mesh: Mesh, most_faces: int) -> Mesh:
    """Collapse edges where that changes least; where it gets stuck, corners that are close are joined before."""
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
    """Join all corners in a cell of a grid, with larger cells until there are few enough faces.

    A surface crosses about 6 n² cells of n³, with two faces each. Of what comes apart before (confetti), the largest
    faces are kept.
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
    """Return a mesh with one corner in the middle of all that are in the same cell of a grid."""
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
