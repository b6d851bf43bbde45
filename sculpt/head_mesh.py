"""The mesh of a head: even triangles, fine at lids, lips, nose and ears, and a mouth that can open. Lengths are mm.

It is slit between the lips, and a pocket lies behind them.
"""

from collections.abc import Callable
from itertools import pairwise

import cutting
import meshing
import numpy as np
from cutting import lengths_around
from faces import FaceShape
from fields import Array, Field
from head import Head, field, folded, mouth_corner, mouth_line, opening

from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.geometry.solvers import smoothstep

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
    close = near & (np.abs(height) < 0.42 * lengths_around(verts, faces))
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


POLE_DEG = -16.0
"""Elevation of the direction in the middle of the picture, below the eyes; the picture ends opposite, in the hair."""
NEAR_RAD = np.radians(60.0)
"""Within about this angle of the middle the picture is even; what is behind, under hair, is smaller and smaller."""


def unwrapped(directions: FloatArray) -> FloatArray:
    """Return the places of directions in the picture, from its lower left, 0 to 1, shape (n, 2).

    Args:
        directions: From the middle of the head, in its half axes: x forward, y left, z up; shape (n, 3).
    """
    along = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    middle, right, up = _axes()
    far = np.arccos(np.clip(along @ middle, -1, 1))
    x, y = along @ right, along @ up
    across = np.maximum(np.hypot(x, y), 1e-12)
    radius = 0.5 * np.tanh(far / NEAR_RAD) / np.tanh(np.pi / NEAR_RAD)
    return np.stack((0.5 + radius * x / across, 0.5 + radius * y / across), axis=-1)


def wrapped(places: FloatArray) -> FloatArray:
    """Return the directions that places in the picture show, unit vectors, shape (..., 3); beyond its edge, the edge's.

    Args:
        places: From the lower left, 0 to 1, shape (..., 2).
    """
    x, y = places[..., 0] - 0.5, places[..., 1] - 0.5
    radius = np.hypot(x, y)
    angle = NEAR_RAD * np.arctanh(np.minimum(2 * radius, 1) * np.tanh(np.pi / NEAR_RAD))
    middle, right, up = _axes()
    share = np.sin(angle) / np.maximum(radius, 1e-12)
    return np.cos(angle)[..., None] * middle + (share * x)[..., None] * right + (share * y)[..., None] * up


def _axes() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the direction in the middle of the picture, and those to its right and its top, for one who faces it."""
    pole = np.radians(POLE_DEG)
    middle = np.array((np.cos(pole), 0.0, np.sin(pole)))
    right = np.array((0.0, 1.0, 0.0))
    return middle, right, np.cross(middle, right)


EAR_MM = (-6.4, -66.0, -14.0)  # Middle of the right ear.
EASED = (0.55, -0.42, 0.55, -0.42, 0.55)
"""How far vertices of an ear go towards the middle of their neighbours, and back, so that it does not shrink."""
HEM_MM = 1.6  # Breadth of the strip along the rim of a lid, which leads to the eyeball.


def mesh(head: Head, shape: FaceShape, rng: np.random.Generator) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return the mesh of a head with open lids, the same on both sides, and for each vertex the one it moves with."""
    whole = field(head, shape)
    reach = head.half_axes + 18
    dense = meshing.largest(*meshing.surface(whole, -reach, np.add(reach, (8, 0, 0)), 0.9))
    verts, faces = meshing.remesh(*dense, lambda points: sizes(head, shape, points), rng)
    verts = meshing.relax(whole, meshing.onto(whole, verts), faces, 2, 0.4)
    verts, faces = cutting.made_symmetric(verts, faces)
    verts = _with_smooth_ears(meshing.relax(whole, verts, faces, 2, 0.4), faces)
    verts, faces = slit(mouth_line(head, shape), mouth_corner(head, shape), verts, faces)
    return cutting.hemmed(whole, opening(head), HEM_MM, verts, faces)


def ear_share(points: Array) -> Array:
    """Return how much points belong to an ear, 0 to 1, shape (n,)."""
    far = np.linalg.norm((folded(points) - EAR_MM) / (1.0, 0.8, 1.4), axis=1)
    return smoothstep((20 - far) / 6)


def _with_smooth_ears(verts: Array, faces: np.ndarray) -> Array:
    """Return vertices whose ears are without spikes, which a thin rim has where the surface behind it is near."""
    edges = meshing.edges_of(faces)
    both = np.vstack((edges, edges[:, ::-1]))
    count = np.bincount(both[:, 0], minlength=len(verts))[:, None]
    share = ear_share(verts)[:, None]
    for step in EASED:
        sums = np.zeros_like(verts)
        np.add.at(sums, both[:, 0], verts[both[:, 1]])
        verts = verts + step * share * (sums / count - verts)
    return verts


def sizes(head: Head, shape: FaceShape, points: Array) -> Array:
    """Return the lengths of edges that are wanted at some points."""
    n, q = points / head.half_axes, folded(points)
    eye = np.linalg.norm(q - head.eye, axis=1)
    nose = np.linalg.norm(points - (shape.tip[0], 0, shape.tip[1]), axis=1)
    lips = (points - (shape.mouth[0] - 4, 0, shape.mouth[1])) / (18.0, 19.5, 10.5)
    wanted = np.where(n[:, 0] < -0.1, 11.5, 9.8)
    wanted = np.where((n[:, 2] < -0.2) & (n[:, 0] > 0.0), 8.0, wanted)
    wanted = np.where((n[:, 0] > 0.42) & (n[:, 2] > 0.1) & (n[:, 2] < 0.75), 8.5, wanted)
    wanted = np.where((n[:, 0] > 0.42) & (n[:, 2] < 0.32) & (n[:, 2] > -0.95), 6.0, wanted)
    end = np.linalg.norm(points / head.half_axes + wrapped(np.array((0.5, 0.5))), axis=1)
    wanted = np.where(end < 0.3, 7.0, wanted)
    wanted = np.where(nose < 13, 3.0, wanted)
    ear = np.linalg.norm((q - EAR_MM) / (1.0, 0.8, 1.4), axis=1)
    wanted = np.where((ear < 17) & (q[:, 1] < -0.97 * head.half_axes[1]), 3.5, wanted)
    wanted = np.where(eye < head.eye_radius * 1.8, 3.4, wanted)
    far = np.linalg.norm(lips, axis=1)
    wanted = np.where(far < 1.5, np.minimum(wanted, 3.8), wanted)
    wanted = np.where(far < 1, 2.4, wanted)
    wanted = np.where(np.linalg.norm(lips * (1, 1.1, 2.6), axis=1) < 1, 1.7, wanted)
    return np.where(eye < head.eye_radius * 1.25, 2.2, wanted)


def lip_sides(line: Field, verts: Array, faces: np.ndarray, twins: np.ndarray) -> np.ndarray:
    """Return 1 for what moves with the upper lip and -1 for what does with the lower one, shape (n,).

    Where the lips meet, there are two vertices in one place; the faces at each tell them apart.
    """
    on_edge = np.isin(np.arange(len(verts)), twins[twins != np.arange(len(verts))])
    height, around = np.where(on_edge, 0.0, line(verts)), np.zeros(len(verts))
    surface = faces[(twins[faces] == faces).all(axis=1)]
    np.add.at(around, surface, np.repeat(height[surface].sum(axis=1)[:, None], 3, axis=1))
    side = np.where(np.where(on_edge, around, height) >= 0, 1, -1)
    return side[twins]


def texcoords(head: Head, verts: Array) -> Array:
    """Return places in the face's texture, (n, 2): see `uv_map`."""
    return unwrapped(verts / head.half_axes)


def split_at_end(head: Head, verts: Array, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, Array]:
    """Return a mesh in which each triangle has a vertex of its own where the picture ends.

    Vertices as indices of those before, faces, and texture coordinates.

    The whole border of the picture is one point of the head.
    """
    end = -wrapped(np.array((0.5, 0.5)))
    along = verts / head.half_axes
    nearest = int((along @ end / np.linalg.norm(along, axis=1)).argmax())
    origin = np.arange(len(verts))
    places, faces = texcoords(head, verts), faces.copy()
    for index, corner in np.argwhere(faces == nearest)[1:]:
        faces[index, corner] = len(origin)
        origin, places = np.append(origin, nearest), np.vstack((places, places[nearest]))
    for index, corner in np.argwhere(origin[faces] == nearest):
        middle = (places[np.delete(faces[index], corner)] - 0.5).sum(axis=0)
        places[faces[index, corner]] = 0.5 + 0.5 * middle / np.linalg.norm(middle)
    return origin, faces, places
