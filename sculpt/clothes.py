"""Layers that are cut along smooth lines: lids. Lengths are mm."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from fields import Array, Field
from meshing import gradient, largest, without_slivers

SLIVER = 0.22
"""Edges shorter than this share of the usual ones are drawn together."""


@dataclass(frozen=True)
class Cloth:
    """A layer that is cut."""

    name: str
    layer: Field
    """Outside of the cloth."""
    cut: Callable[[Array], Array]
    """Positive where there is no cloth; about the distance to its edge."""
    bare: Callable[[Array], Array]
    """The same for the edges beside which one sees skin."""
    hem_mm: float
    """Breadth of the fold along the edge, which leads into the skin, so that nobody sees into the cloth."""


def sewn(cloth: Cloth, verts: Array, faces: np.ndarray) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return the part of a mesh that is cloth, cut along a smooth line, with a hem that is folded inwards.

    Args:
        cloth: The layer and its edges.
        verts: Of the whole layer.
        faces: Of the whole layer.

    Returns:
        Vertices, faces, and for each vertex the one that it moves with: itself, or of the hem's that at the edge.
    """
    away = cloth.cut(verts)
    slope = gradient(cloth.cut, verts, 0.2)
    size = np.linalg.norm(slope, axis=1)
    lengths = np.linalg.norm(verts[faces[:, 0]] - verts[faces[:, 1]], axis=1)
    typical = np.bincount(faces[:, 0], lengths, minlength=len(verts)) / np.maximum(
        np.bincount(faces[:, 0], minlength=len(verts)), 1
    )
    close = (np.abs(away) < 0.3 * typical) & (size > 0.3) & (size < 3)
    verts = verts.copy()
    verts[close] -= (away[close] / size[close] ** 2)[:, None] * slope[close]
    away[close] = 0.0
    verts, faces = without_slivers(*_clipped(verts, faces, away), least=SLIVER * float(np.median(typical)))
    return _hemmed(cloth.layer, *largest(verts, faces), cloth.hem_mm)


def _clipped(verts: Array, faces: np.ndarray, away: Array) -> tuple[Array, np.ndarray]:
    """Return the faces where *away* is not positive, cut where it is zero."""
    new: dict[tuple[int, int], int] = {}
    points = list(verts)
    found = []

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
            found.append(face)
            continue
        polygon = []
        for a, b in zip(face, np.roll(face, -1), strict=True):
            if away[a] <= 0:
                polygon.append(a)
            if (away[a] < 0 < away[b]) or (away[b] < 0 < away[a]):
                polygon.append(crossing(a, b))
        found += [(polygon[0], polygon[i], polygon[i + 1]) for i in range(1, len(polygon) - 1)]
    all_points, faces = np.array(points), np.array(found, np.int64)
    used = np.unique(faces)
    number = np.full(len(all_points), -1)
    number[used] = np.arange(len(used))
    return all_points[used], number[faces]


def _hemmed(layer: Field, verts: Array, faces: np.ndarray, hem_mm: float) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return a mesh with a strip along its open edges that leads inwards; its edge is sharp: a rim of its own."""
    directed = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    pairs = {tuple(pair) for pair in directed}
    rim = [(a, b) for a, b in pairs if (b, a) not in pairs]
    ends = np.unique(np.array(rim))
    normal = gradient(layer, verts[ends])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    outer = {int(vertex): len(verts) + number for number, vertex in enumerate(ends)}
    inner = {vertex: number + len(ends) for vertex, number in outer.items()}
    quads = [(outer[a], outer[b], inner[a], inner[b]) for a, b in sorted(rim)]
    strip = [face for a, b, below_a, below_b in quads for face in ((b, a, below_a), (b, below_a, below_b))]
    twins = np.concatenate((np.arange(len(verts)), ends, ends))
    return np.vstack((verts, verts[ends], verts[ends] - hem_mm * normal)), np.vstack((faces, np.array(strip))), twins
