"""Cutting a mesh along a line: the lids along their rims, a head down its middle. Lengths are mm."""

from collections.abc import Callable

import numpy as np
from fields import Array, Field
from meshing import gradient, largest, without_slivers

SLIVER = 0.22  # Edges shorter than this share of the usual ones are drawn together.


def hemmed(
    field: Field, cut: Callable[[Array], Array], hem_mm: float, verts: Array, faces: np.ndarray
) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return the part of a mesh where *cut* is negative, with a strip along its edge that leads inwards.

    Args:
        field: What the mesh is the surface of.
        cut: Positive where the mesh is cut away; about the distance to the edge.
        hem_mm: Breadth of the strip.
        verts: Of the mesh.
        faces: Of the mesh.

    Returns:
        Vertices, faces, and for each vertex the one that it moves with: itself, or of the strip's that at the edge.
    """
    away, slope = cut(verts), gradient(cut, verts, 0.2)
    size = np.linalg.norm(slope, axis=1)
    typical = typical_edge(verts, faces)
    close = (np.abs(away) < 0.3 * typical) & (size > 0.3) & (size < 3)
    verts = verts.copy()
    verts[close] -= (away[close] / size[close] ** 2)[:, None] * slope[close]
    away[close] = 0.0
    verts, faces = without_slivers(*clipped(verts, faces, away), least=SLIVER * float(np.median(typical)))
    return _with_strip(field, *largest(verts, faces), hem_mm)


def typical_edge(verts: Array, faces: np.ndarray) -> Array:
    """Return the mean length of the edges at each vertex."""
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    lengths = np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1)
    count = np.bincount(edges[:, 0], minlength=len(verts))
    return np.bincount(edges[:, 0], lengths, minlength=len(verts)) / np.maximum(count, 1)


def clipped(verts: Array, faces: np.ndarray, away: Array) -> tuple[Array, np.ndarray]:
    """Return the faces where *away* is not positive, cut where it is zero."""
    new: dict[tuple[int, int], int] = {}
    points, kept = list(verts), []

    def crossing(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in new:
            new[key] = len(points)
            share = away[a] / (away[a] - away[b])
            points.append(verts[a] + share * (verts[b] - verts[a]))
        return new[key]

    for face in faces:
        signs = away[face] > 0
        if not signs.any():
            kept.append(face)
            continue
        polygon = []
        for a, b in zip(face, np.roll(face, -1), strict=True):
            if away[a] <= 0:
                polygon.append(a)
            if (away[a] < 0 < away[b]) or (away[b] < 0 < away[a]):
                polygon.append(crossing(a, b))
        kept += [(polygon[0], polygon[i], polygon[i + 1]) for i in range(1, len(polygon) - 1)]
    every, faces = np.array(points), np.array(kept, np.int64)
    used = np.unique(faces)
    number = np.full(len(every), -1)
    number[used] = np.arange(len(used))
    return every[used], number[faces]


def mirrored(verts: Array, faces: np.ndarray) -> tuple[Array, np.ndarray]:
    """Return the half of a mesh where y is negative, and its image on the other side."""
    half = verts.copy()
    half[np.abs(half[:, 1]) < 0.3 * typical_edge(verts, faces), 1] = 0.0
    half, kept = clipped(half, faces, half[:, 1])
    on_seam = np.abs(half[:, 1]) < 1e-9
    number = np.where(on_seam, np.arange(len(half)), len(half) + np.cumsum(~on_seam) - 1)
    both = np.vstack((half, half[~on_seam] * (1, -1, 1)))
    whole = ~on_seam[kept].all(axis=1)  # A triangle that lies in the middle would be there twice.
    return both, np.vstack((kept[whole], number[kept[whole]][:, ::-1]))


def _with_strip(field: Field, verts: Array, faces: np.ndarray, hem_mm: float) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return a mesh with a strip along its open edges that leads inwards; its edge is sharp: a rim of its own."""
    directed = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    pairs = {tuple(pair) for pair in directed}
    rim = [(a, b) for a, b in pairs if (b, a) not in pairs]
    ends = np.unique(np.array(rim))
    normal = gradient(field, verts[ends])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    outer = {int(vertex): len(verts) + number for number, vertex in enumerate(ends)}
    inner = {vertex: number + len(ends) for vertex, number in outer.items()}
    quads = [(outer[a], outer[b], inner[a], inner[b]) for a, b in sorted(rim)]
    strip = [face for a, b, below_a, below_b in quads for face in ((b, a, below_a), (b, below_a, below_b))]
    twins = np.concatenate((np.arange(len(verts)), ends, ends))
    return np.vstack((verts, verts[ends], verts[ends] - hem_mm * normal)), np.vstack((faces, np.array(strip))), twins
