"""A mouth that can open: the head's mesh is slit between the lips, and a pocket lies behind them. Lengths are mm."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from cutting import typical_edge
from fields import Array

Line = Callable[[Array], Array]  # About the height above the line on which the lips meet, of points near it.
POCKET = ((1.0, 0.0), (0.85, 5.0), (0.5, 9.0))
"""Rings of the pocket: their size by that of the slit's inner edge, and how far behind it they are."""
PATCH = (0.068, 0.062)
"""The pocket's place in the picture of the face, whose corners are empty: middle, from the lower left, and radius."""


def slit(line: Line, corner: Array, verts: Array, faces: np.ndarray) -> tuple[Array, np.ndarray]:
    """Return the vertices and faces of a mesh with open edges where the lips meet.

    Args:
        line: See `Line`.
        corner: The right corner of the mouth.
        verts: Of the mesh.
        faces: Of the mesh.
    """
    verts, ends = verts.copy(), []
    for sign in (-1.0, 1.0):
        place = corner * (1, -sign, 1)
        ends.append(int(np.linalg.norm(verts - place, axis=1).argmin()))
        verts[ends[-1]] = place
    inside = np.abs(verts[:, 1]) < abs(corner[1]) - 0.5
    near = (np.linalg.norm((verts - corner * (1, 0, 1)) / (14, 1e9, 7), axis=1) < 1) & inside
    height = np.where(near | (np.abs(verts[:, 1]) < 30) & (verts[:, 0] > 45), line(verts), 99.0)
    close = near & (np.abs(height) < 0.42 * typical_edge(verts, faces))
    close[ends] = False
    for _ in range(4):
        verts[close, 2] -= 0.8 * line(verts[close])
    height[close], height[ends] = 0.0, 0.0
    verts, faces, height = _crossed(verts, faces, height, abs(corner[1]) - 0.05)
    on_line = (height == 0) & ~np.isin(np.arange(len(verts)), ends)
    number = np.where(on_line, len(verts) + np.cumsum(on_line) - 1, np.arange(len(verts)))
    below = np.where(height[faces] == 0, 0, height[faces]).sum(axis=1) < 0
    parted = np.where(below[:, None], number[faces], faces)
    return np.vstack((verts, verts[on_line])), parted


def _crossed(verts: Array, faces: np.ndarray, height: Array, half: float) -> tuple[Array, np.ndarray, Array]:
    """Return a mesh with vertices wherever the line crosses edges between the corners of the mouth."""
    new: dict[tuple[int, int], int] = {}
    points, heights, kept = list(verts), list(height), []

    def crossing(a: int, b: int) -> int | None:
        if height[a] * height[b] >= 0 or max(abs(height[a]), abs(height[b])) > 90:
            return None
        point = verts[a] + height[a] / (height[a] - height[b]) * (verts[b] - verts[a])
        if abs(point[1]) > half:
            return None
        key = (min(a, b), max(a, b))
        if key not in new:
            new[key] = len(points)
            points.append(point)
            heights.append(0.0)
        return new[key]

    for face in faces:
        loop = []
        for a, b in zip(face.tolist(), np.roll(face, -1).tolist(), strict=True):
            loop.append(a)
            if (middle := crossing(a, b)) is not None:
                loop.append(middle)
        for part in _halves(loop, heights):
            kept += [(part[0], part[i], part[i + 1]) for i in range(1, len(part) - 1)]
    return np.array(points), np.array(kept, np.int64), np.array(heights)


def _halves(loop: list[int], heights: list[float]) -> list[list[int]]:
    """Return the parts of a polygon above and below the line, if it crosses both."""
    if len(loop) == 3:
        return [loop]
    parts = []
    for sign in (1, -1):
        part = [index for index in loop if sign * heights[index] >= 0]
        if any(heights[index] for index in part):
            parts.append(part)
    return parts


def loop_around(rim: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the vertices of the open edge of a mesh that passes through some of its vertices, in order."""
    directed = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    pairs = {tuple(pair) for pair in directed.tolist()}
    following = {b: a for a, b in pairs if (b, a) not in pairs}
    start = int(rim[0])
    loop = [start]
    while (after := following[loop[-1]]) != start:
        loop.append(after)
    return np.array(loop)


def pocket(verts: Array, loop: np.ndarray) -> Array:
    """Return the vertices of the pocket behind the inner edge of the lips, and its bottom, the last."""
    edge = verts[loop]
    middle = edge.mean(axis=0)
    rings = [middle + size * (edge - middle) - (depth, 0, 0) for size, depth in POCKET]
    return np.vstack((*rings, middle - (POCKET[-1][1] + 2.0, 0, 0)))


def pocket_faces(count: int, first: int) -> np.ndarray:
    """Return the faces of a pocket around a loop of so many vertices, whose own begin with *first*."""
    rings = [first + count * ring + np.arange(count) for ring in range(len(POCKET))]
    bottom = first + count * len(POCKET)
    faces = []
    for outer, inner in pairwise(rings):
        for a in range(count):
            b = (a + 1) % count
            faces += [(outer[a], outer[b], inner[a]), (outer[b], inner[b], inner[a])]
    return np.array([*faces, *((rings[-1][a], rings[-1][(a + 1) % count], bottom) for a in range(count))])


def pocket_places(edge: Array, side: np.ndarray) -> Array:
    """Return the places in the picture of the vertices of a pocket.

    Args:
        edge: The vertices that it begins behind, in order.
        side: 1 for those of the upper lip, -1 for those of the lower.
    """
    angle = _angles(edge[:, 1], side)
    ways = np.column_stack((np.sin(angle), np.cos(angle)))
    rings = [PATCH[0] + PATCH[1] * size * ways for size, _ in POCKET]
    return np.vstack((*rings, np.full((1, 2), PATCH[0])))


def _angles(aside: Array, side: np.ndarray) -> Array:
    """Return the angle of each vertex of an edge around the mouth, from the top to the left, evenly spaced."""
    count, left, right = len(aside), int(aside.argmax()), int(aside.argmin())
    forth, step = (right - left) % count, (np.arange(count) - left) % count
    way = np.sign(side[(left + np.arange(1, forth)) % count].sum())
    return np.pi / 2 - way * np.pi * np.where(step <= forth, step / forth, 1 + (step - forth) / (count - forth))
