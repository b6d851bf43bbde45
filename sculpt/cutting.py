"""Cutting meshes where functions are zero: away, with a strip along the edge, or so that edges run along curves.

A curve is drawn into the right half of a symmetric mesh: its edges are split, so that hems run along edges. Lengths are
mm.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from fields import Array, Field
from meshing import edges_of, gradient, largest, only, without_fins, without_slivers

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
    typical = lengths_around(verts, faces)
    close = (np.abs(away) < 0.3 * typical) & (size > 0.3) & (size < 3)
    verts = verts.copy()
    verts[close] -= (away[close] / size[close] ** 2)[:, None] * slope[close]
    away[close] = 0.0
    verts, faces = without_slivers(*clipped(verts, faces, away), least=SLIVER * float(np.median(typical)))
    return _with_strip(field, *largest(verts, faces), hem_mm)


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
    return only(np.array(points), np.array(kept, np.int64), np.ones(len(points), bool))


def made_symmetric(verts: Array, faces: np.ndarray) -> tuple[Array, np.ndarray]:
    """Return the half of a mesh where y is negative, and its image on the other side."""
    half = verts.copy()
    half[np.abs(half[:, 1]) < 0.3 * lengths_around(verts, faces), 1] = 0.0
    half, kept = clipped(half, faces, half[:, 1])
    on_seam = np.abs(half[:, 1]) < 1e-9
    kept = kept[~on_seam[kept].all(axis=1)]  # A triangle that lies in the middle would be there twice.
    return _with_image(half, kept, on_seam)[:2]


def _with_image(verts: Array, faces: np.ndarray, on_seam: np.ndarray) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return a half and its mirror image as one mesh, and the mirror image of each vertex."""
    (free,) = np.nonzero(~on_seam)
    other = np.arange(len(verts))
    other[free] = len(verts) + np.arange(len(free))
    both = np.vstack((verts, verts[free] * (1, -1, 1)))
    return both, np.vstack((faces, other[faces][:, ::-1])), np.concatenate((other, free))


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


SNAPPED = 0.34  # A vertex that is within this share of its edges' length of a curve moves onto it.
SHORT, ROUNDS = 0.55, 6
"""Edges shorter than this share of the wanted length are drawn together; how often the mesh is made even."""


@dataclass(frozen=True)
class Curve:
    """Where a function is zero on a surface."""

    level: Field  # About the distance to the curve, negative on its inner side.
    window: Callable[[Array], np.ndarray]  # Whether points may be near it: elsewhere its zeros do not count.


PLANE = Curve(lambda p: p[:, 1], lambda p: np.ones(len(p), bool))  # The plane of symmetry.


@dataclass(frozen=True)
class Drawn:
    """A mesh with curves in it."""

    verts: Array
    faces: np.ndarray
    lies_on: np.ndarray  # Whether each vertex is on each curve, shape (n, curves).
    twins: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    """The mirror image of each vertex, of a whole mesh."""


def right_half(surface: Field, verts: Array, faces: np.ndarray) -> Drawn:
    """Return the half at negative y of a mesh, whose edge is in the plane of symmetry."""
    cut = _split(surface, Drawn(verts, faces, np.zeros((len(verts), 0), bool)), (PLANE,))
    right = (cut.verts[:, 1] < 0) | cut.lies_on[:, 0]
    is_on = cut.lies_on[:, 0].astype(float)
    kept, small = only(np.column_stack((cut.verts, is_on)), cut.faces, right)
    small = small[~(kept[small, 3] > 0).all(axis=1)]
    return Drawn(kept[:, :3], small, kept[:, 3:] > 0)


def embedded(surface: Field, half: Drawn, curves: Sequence[Curve], size: Callable[[Array], Array]) -> Drawn:
    """Return the half of a mesh with curves drawn into it, and with even triangles beside them.

    Args:
        surface: The field whose surface the mesh lies on.
        half: As `right_half` returns it.
        curves: They do not cross each other.
        size: Length of edges that is wanted at some points.
    """
    everywhere, drawn = (PLANE, *curves), half
    for number in range(1, len(everywhere)):
        drawn = _split(surface, drawn, everywhere[: number + 1])
    for _ in range(ROUNDS):
        drawn = _collapsed(surface, drawn, everywhere, size)
        drawn = Drawn(drawn.verts, flipped(drawn.verts, without_fins(drawn.faces), drawn.lies_on), drawn.lies_on)
        drawn = _relaxed(surface, drawn, everywhere)
    return drawn


def mirrored(drawn: Drawn) -> Drawn:
    """Return both halves as one mesh."""
    on_seam = drawn.lies_on[:, 0]
    verts, faces, twins = _with_image(drawn.verts, drawn.faces, on_seam)
    return Drawn(verts, faces, np.vstack((drawn.lies_on, drawn.lies_on[~on_seam])), twins)


def placed(surface: Field, curves: Sequence[Curve], verts: Array, lies_on: np.ndarray, rounds: int = 3) -> Array:
    """Return vertices on the surface, and on their curves."""
    flat = np.where(lies_on[:, :1], (1.0, 0.0, 1.0), 1.0)
    for _ in range(rounds):
        for number, curve in enumerate(curves):
            (on,) = np.nonzero(lies_on[:, number])
            if len(on):
                verts = _step(curve.level, verts, on, flat if number else np.ones_like(flat), surface)
        verts = _step(surface, verts, np.arange(len(verts)), flat, None)
    return verts


def _step(field: Field, verts: Array, chosen: np.ndarray, flat: Array, surface: Field | None) -> Array:
    """Return vertices of which some took a step towards the zero of a field, along a surface if there is one."""
    points = verts[chosen]
    slope = gradient(field, points) * flat[chosen]
    if surface is not None:
        normal = gradient(surface, points) * flat[chosen]
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
        slope = slope - (slope * normal).sum(axis=1, keepdims=True) * normal
    move = np.clip(field(points) / np.maximum((slope**2).sum(axis=1), 0.05), -3, 3)
    moved = verts.copy()
    moved[chosen] = points - move[:, None] * slope
    return moved


def _split(surface: Field, drawn: Drawn, curves: Sequence[Curve]) -> Drawn:
    """Return a mesh in which the last of some curves is drawn; the others are already."""
    curve, verts = curves[-1], drawn.verts
    lies_on = np.column_stack((drawn.lies_on, np.zeros(len(verts), bool)))
    near = curve.window(verts)
    slope = gradient(curve.level, verts)
    steep = np.maximum(np.linalg.norm(slope, axis=1), 0.2)
    close = near & (np.abs(curve.level(verts)) / steep < SNAPPED * lengths_around(verts, drawn.faces))
    lies_on[:, -1] = close & (drawn.lies_on[:, 1:].sum(axis=1) == 0)
    verts = placed(surface, curves, verts, lies_on)
    away = np.where(lies_on[:, -1], 0.0, np.where(near, curve.level(verts), np.nan))
    edges = edges_of(drawn.faces)
    crossed = edges[away[edges[:, 0]] * away[edges[:, 1]] < 0]
    share = away[crossed[:, 0]] / (away[crossed[:, 0]] - away[crossed[:, 1]])
    new = verts[crossed[:, 0]] + share[:, None] * (verts[crossed[:, 1]] - verts[crossed[:, 0]])
    new_on = lies_on[crossed].all(axis=1)
    new_on[:, -1] = True
    between = {tuple(edge): len(verts) + number for number, edge in enumerate(crossed.tolist())}
    lies_on = np.vstack((lies_on, new_on))
    verts = placed(surface, curves, np.vstack((verts, new)), lies_on)
    return Drawn(verts, _cut_faces(drawn.faces, between, verts), lies_on)


def _cut_faces(faces: np.ndarray, between: Mapping[tuple[int, int], int], verts: Array) -> np.ndarray:
    """Return faces that are split at new vertices on their edges: *between* two vertices there is another."""
    made: list[tuple[int, ...]] = []
    for a, b, c in faces.tolist():
        corners = [(a, b, c), (b, c, a), (c, a, b)]
        middle = [between.get((min(i, j), max(i, j))) for i, j, _ in corners]
        cuts = sum(vertex is not None for vertex in middle)
        if cuts == 0:
            made.append((a, b, c))
        elif cuts == 1:
            turn = next(index for index in range(3) if middle[index] is not None)
            i, j, k = corners[turn]
            made += [(i, middle[turn], k), (middle[turn], j, k)]
        else:
            turn = next(index for index in range(3) if middle[index] is not None and middle[index - 1] is not None)
            i, j, k = corners[turn]
            one, other = middle[turn], middle[turn - 1]
            made.append((i, one, other))
            if np.linalg.norm(verts[one] - verts[k]) < np.linalg.norm(verts[other] - verts[j]):
                made += [(one, j, k), (one, k, other)]
            else:
                made += [(one, j, other), (other, j, k)]
    return np.array(made, np.int64)


def lengths_around(verts: Array, faces: np.ndarray) -> Array:
    """Return the mean length of each vertex's edges."""
    edges = edges_of(faces)
    lengths = np.repeat(np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1), 2)
    return np.bincount(edges.ravel(), lengths, len(verts)) / np.maximum(np.bincount(edges.ravel(), None, len(verts)), 1)


def _relaxed(surface: Field, drawn: Drawn, curves: Sequence[Curve]) -> Drawn:
    """Return a mesh whose vertices are nearer to the middle of their neighbours; those on a curve, of those on it.

    The edge of an opening stays.
    """
    edges = edges_of(drawn.faces)
    both = np.vstack((edges, edges[:, ::-1]))
    both = both[(drawn.lies_on[both[:, 0]] <= drawn.lies_on[both[:, 1]]).all(axis=1)]
    count = np.bincount(both[:, 0], minlength=len(drawn.verts))
    sums = np.column_stack(
        [np.bincount(both[:, 0], drawn.verts[both[:, 1], axis], len(drawn.verts)) for axis in range(3)]
    )
    used, times = np.unique(
        np.sort(drawn.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_counts=True
    )
    open_ends = used[(times == 1) & ~drawn.lies_on[used, 0].all(axis=1)]
    count[open_ends] = 0
    means = np.where(count[:, None] > 1, sums / np.maximum(count, 1)[:, None], drawn.verts)
    verts = drawn.verts + 0.5 * (means - drawn.verts)
    return Drawn(placed(surface, curves, verts, drawn.lies_on, 2), drawn.faces, drawn.lies_on)


def _collapsed(surface: Field, drawn: Drawn, curves: Sequence[Curve], size: Callable[[Array], Array]) -> Drawn:
    """Return a mesh without edges that are much shorter than wanted."""
    verts, faces, lies_on = drawn.verts.copy(), drawn.faces.copy(), drawn.lies_on
    edges = edges_of(faces)
    lengths = np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1)
    wanted = size(verts)
    relative = lengths / wanted[edges].mean(axis=1)
    around: list[set[int]] = [set() for _ in verts]
    for a, b in edges.tolist():
        around[a].add(b)
        around[b].add(a)
    target, busy = np.arange(len(verts)), np.zeros(len(verts), bool)
    for index in np.argsort(relative, kind="stable"):
        if relative[index] > SHORT:
            break
        a, b = map(int, edges[index])
        near = around[a] | around[b]
        outer = (lies_on[a] & lies_on[b]).any() and lies_on[a][0] and lies_on[b][0]
        if busy[list(near)].any() or len(around[a] & around[b]) != (1 if outer else 2):
            continue
        if not (lies_on[a] <= lies_on[b]).all():
            a, b = b, a
        if not (lies_on[a] <= lies_on[b]).all():
            continue
        if (lies_on[a] == lies_on[b]).all():
            verts[b] = (verts[a] + verts[b]) / 2
        target[a] = b
        busy[list(near)] = True
    faces = target[faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    faces = faces[whole]
    used = np.unique(faces)
    number = np.zeros(len(verts), np.int64)
    number[used] = np.arange(len(used))
    return Drawn(placed(surface, curves, verts[used], lies_on[used], 1), number[faces], lies_on[used])


def flipped(verts: Array, faces: np.ndarray, lies_on: np.ndarray) -> np.ndarray:
    """Return faces of which two that share an edge get the other diagonal where it makes them less thin."""
    faces = faces.copy()
    directed = {
        (int(face[i]), int(face[(i + 1) % 3])): (number, int(face[(i + 2) % 3]))
        for number, face in enumerate(faces)
        for i in range(3)
    }
    joined = {frozenset(edge) for edge in directed}
    done: set[int] = set()
    for (a, b), (one, c) in sorted(directed.items()):
        if a > b or (b, a) not in directed or (lies_on[a] & lies_on[b]).any():
            continue
        other, d = directed[b, a]
        if one in done or other in done or frozenset((c, d)) in joined:
            continue
        if _angle(verts, c, a, b) + _angle(verts, d, a, b) > np.pi + 0.05 and _is_flat(verts, (a, b, c, d)):
            faces[one], faces[other] = (c, d, b), (d, c, a)
            done |= {one, other}
            joined.add(frozenset((c, d)))
    return faces


def _angle(verts: Array, at: int, a: int, b: int) -> float:
    u, v = verts[a] - verts[at], verts[b] - verts[at]
    return float(np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v))


def _is_flat(verts: Array, corners: Sequence[int]) -> bool:
    """Return whether both new triangles look to the side that the old ones look to."""
    a, b, c, d = (verts[corner] for corner in corners)
    before = np.cross(b - a, c - a) + np.cross(a - b, d - b)
    return bool(np.cross(d - c, b - c) @ before > 0 and np.cross(c - d, a - d) @ before > 0)
