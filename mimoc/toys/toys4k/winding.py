"""Winding of the faces of a mesh, so that they face outwards."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mimoc.toys.model import FloatArray, IntArray, Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A mesh and its shells, which are connected at edges of two triangles."""

    mesh: Mesh
    shells: IntArray
    """Index of the shell of each face."""
    closed: npt.NDArray[np.bool_]
    """Whether the shell of each face is closed: all of its edges have two faces."""


def face_outwards(mesh: Mesh) -> Surface:
    """Return a mesh in which the faces of each shell are wound consistently, so that its volume is positive."""
    edges, ahead = _edges(mesh.faces)
    first, second, face_pairs = _pairs(edges)
    count = len(mesh.faces)
    same = (ahead[first] == ahead[second]).astype(np.intp)
    a, b = face_pairs.T
    links = np.concatenate([np.stack([a, b + count * same], 1), np.stack([a + count, b + count * (1 - same)], 1)])
    labels = _components(links, 2 * count).reshape(2, count)
    _, shells = np.unique(labels.min(axis=0), return_inverse=True)
    faces = _flipped(mesh.faces, labels[0] > labels[1])
    faces = _flipped(faces, (_volumes(mesh.vertices, faces, shells) < 0)[shells])
    open_shells = np.union1d(shells[labels[0] == labels[1]], _open(edges, shells))
    return Surface(Mesh(mesh.vertices, faces), shells, ~np.isin(shells, open_shells))


def from_both_sides(mesh: Mesh) -> Mesh:
    """Return a mesh joined with a copy wound the other way, since MuJoCo renders triangles from the front only."""
    faces = np.concatenate([mesh.faces, mesh.faces[:, ::-1] + len(mesh.vertices)])
    return Mesh(np.concatenate([mesh.vertices, mesh.vertices]), faces)


def _edges(faces: IntArray) -> tuple[IntArray, npt.NDArray[np.bool_]]:
    """Return an index for each of the three edges of each face, edge by edge, and whether its vertex indices rise."""
    starts, ends = faces.T.ravel(), np.roll(faces, -1, axis=1).T.ravel()
    keys = np.minimum(starts, ends) * (faces.max() + 1) + np.maximum(starts, ends)
    return np.unique(keys, return_inverse=True)[1], starts < ends


def _pairs(edges: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the two positions of every edge that has exactly two faces, and those faces, shape (n, 2)."""
    order = np.argsort(edges, kind="stable")
    counts = np.bincount(edges)
    first = (np.cumsum(counts) - counts)[counts == 2]
    places = np.stack([order[first], order[first + 1]], axis=1)
    return places[:, 0], places[:, 1], places % (len(edges) // 3)


def _components(links: IntArray, count: int) -> IntArray:
    from trimesh.graph import connected_component_labels

    return np.asarray(connected_component_labels(links, node_count=count))


def _open(edges: IntArray, shells: IntArray) -> IntArray:
    """Return the shells that have an edge with one face or more than two."""
    keys, counts = np.unique(np.tile(shells, 3) * (edges.max() + 1) + edges, return_counts=True)
    return keys[counts != 2] // (edges.max() + 1)


def _flipped(faces: IntArray, wrong: npt.NDArray[np.bool_]) -> IntArray:
    return np.where(wrong[:, None], faces[:, ::-1], faces)


def _volumes(vertices: FloatArray, faces: IntArray, shells: IntArray) -> FloatArray:
    """Return the volume of each shell; an open shell is closed by joining its border to its middle."""
    corners = vertices[faces]
    sizes = np.bincount(shells)
    middles = np.stack([np.bincount(shells, corners[..., axis].mean(axis=1)) / sizes for axis in range(3)], axis=1)
    a, b, c = np.moveaxis(corners - middles[shells][:, None], 1, 0)
    return np.bincount(shells, np.einsum("ij,ij->i", np.cross(a, b), c) / 6).astype(float)
