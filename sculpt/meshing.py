"""From a field to a mesh of even triangles of any wanted size."""

from collections.abc import Callable

import numpy as np
from fields import Array, Field
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

BLOCK = 8  # Cells of an edge of the blocks that a volume is sampled in.


def surface(field: Field, low: Array, high: Array, step: float, mirrored: bool = True) -> tuple[Array, np.ndarray]:
    """Return a dense mesh of a field's surface within a box, by marching cubes on the blocks that it passes through.

    Args:
        field: The field.
        low: Of the box, (3,).
        high: Of the box, (3,).
        step: Edge of a cell.
        mirrored: Whether the field is the same at -y, so that only one half is sampled.
    """
    from skimage.measure import marching_cubes  # Tests of the rest do without this library.

    counts = np.ceil((high - low) / step / BLOCK).astype(int)
    if mirrored:
        counts[1] += counts[1] % 2
        low = np.array((low[0], -counts[1] * BLOCK * step / 2, low[2]))
    volume = np.full(counts * BLOCK, 1e3, np.float32)
    corner = np.indices(counts).reshape(3, -1).T
    if mirrored:
        corner = corner[corner[:, 1] < counts[1] // 2]
    middles = low + (corner + 0.5) * BLOCK * step
    coarse = np.concatenate([field(part) for part in np.array_split(middles, max(1, len(middles) // 20000))])
    near = np.abs(coarse) < BLOCK * step * 1.6
    inside = np.argwhere(~near & (coarse < 0))[:, 0]
    for index in inside:
        x, y, z = corner[index] * BLOCK
        volume[x : x + BLOCK, y : y + BLOCK, z : z + BLOCK] = -1e3
    cells = (np.indices((BLOCK,) * 3).reshape(3, -1).T + 0.5) * step
    wanted = np.argwhere(near)[:, 0]
    for part in np.array_split(wanted, max(1, len(wanted) // 64)):
        points = (low + corner[part, None] * BLOCK * step + cells).reshape(-1, 3)
        values = field(points).reshape(len(part), BLOCK, BLOCK, BLOCK)
        for index, block in zip(part, values, strict=True):
            x, y, z = corner[index] * BLOCK
            volume[x : x + BLOCK, y : y + BLOCK, z : z + BLOCK] = block
    if mirrored:
        half = volume.shape[1] // 2
        volume[:, half:] = volume[:, half - 1 :: -1] if half * 2 == volume.shape[1] else volume[:, half::-1]
    verts, faces, _, _ = marching_cubes(volume, 0.0, allow_degenerate=False)
    return low + (verts + 0.5) * step, faces.astype(np.int64)


def largest(verts: Array, faces: np.ndarray) -> tuple[Array, np.ndarray]:
    """Return the largest connected part of a mesh."""
    graph = _graph(verts, faces)
    _, label = connected_components(graph, directed=False)
    keep = label == np.bincount(label).argmax()
    return only(verts, faces, keep)


def only(verts: Array, faces: np.ndarray, keep: np.ndarray) -> tuple[Array, np.ndarray]:
    """Return the faces all of whose vertices are kept."""
    faces = faces[keep[faces].all(axis=1)]
    used = np.unique(faces)
    number = np.full(len(verts), -1)
    number[used] = np.arange(len(used))
    return verts[used], number[faces]


def remesh(
    verts: Array, faces: np.ndarray, size: Callable[[Array], Array], rng: np.random.Generator, rounds: int = 8
) -> tuple[Array, np.ndarray]:
    """Return a mesh with even triangles, whose edges are about as long as wanted at each place.

    The vertices of a dense mesh are gathered around centres, along its edges (geodesic Lloyd); two centres are joined
    where their gatherings touch, and three make a triangle.

    Args:
        verts: Of the dense mesh.
        faces: Of the dense mesh.
        size: Length of edges that is wanted at some points.
        rng: Places the first centres.
        rounds: How often centres are moved to the middle of what is around them.
    """
    wanted = size(verts)
    areas = _vertex_areas(verts, faces)
    density = areas / wanted**2
    count = int(density.sum() / (np.sqrt(3) / 2))
    centres = rng.choice(len(verts), count, replace=False, p=density / density.sum())
    graph = _graph(verts, faces, wanted)
    owner = _nearest(graph, centres)
    for _ in range(rounds):
        total = np.bincount(owner, density, minlength=len(centres))
        alive = total > 0
        sums = np.column_stack(
            [np.bincount(owner, density * verts[:, axis], minlength=len(centres)) for axis in range(3)]
        )
        means = sums / np.maximum(total, 1e-12)[:, None]
        off = np.linalg.norm(verts - means[owner], axis=1)
        order = np.lexsort((off, owner))
        first = np.searchsorted(owner[order], np.arange(len(centres)))
        centres = np.where(alive, order[np.minimum(first, len(order) - 1)], centres)
        centres = np.unique(centres)
        owner = _nearest(graph, centres)
    coarse = np.sort(owner[faces], axis=1)
    distinct = (coarse[:, 0] != coarse[:, 1]) & (coarse[:, 1] != coarse[:, 2])
    _, index = np.unique(coarse[distinct], axis=0, return_index=True)
    triangles = owner[faces[distinct]][np.sort(index)]
    used = np.unique(triangles)
    number = np.full(len(centres), -1)
    number[used] = np.arange(len(used))
    return verts[centres[used]], number[triangles]


def _nearest(graph: csr_matrix, centres: np.ndarray) -> np.ndarray:
    """Return the index of the centre that is nearest to each vertex."""
    _, _, source = dijkstra(graph, directed=False, indices=centres, min_only=True, return_predecessors=True)
    number = np.full(graph.shape[0], 0)
    number[centres] = np.arange(len(centres))
    return number[np.maximum(source, 0)]


def _graph(verts: Array, faces: np.ndarray, wanted: Array | None = None) -> csr_matrix:
    """Return the lengths of all edges, relative to what is wanted at their ends."""
    edges = edges_of(faces)
    lengths = np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1)
    if wanted is not None:
        lengths = lengths / (0.5 * (wanted[edges[:, 0]] + wanted[edges[:, 1]]))
    return coo_matrix((np.maximum(lengths, 1e-9), edges.T), shape=(len(verts),) * 2).tocsr()


def edges_of(faces: np.ndarray) -> np.ndarray:
    """Return each edge once, shape (n, 2)."""
    return np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)


def _vertex_areas(verts: Array, faces: np.ndarray) -> Array:
    a, b, c = verts[faces].transpose(1, 0, 2)
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(faces.ravel(), np.repeat(third, 3), minlength=len(verts))


def gradient(field: Field, points: Array, step: float = 0.05) -> Array:
    """Return the slope of a field, shape (n, 3)."""
    shifts = np.eye(3) * step
    return np.column_stack([(field(points + shift) - field(points - shift)) / (2 * step) for shift in shifts])


def onto(field: Field, points: Array, rounds: int = 3, most: float = 1.0) -> Array:
    """Return points moved along a field's slope onto its surface."""
    for _ in range(rounds):
        slope = gradient(field, points)
        move = field(points) / np.maximum((slope**2).sum(axis=1), 0.05)
        points = points - np.clip(move, -most, most)[:, None] * slope
    return points


def relax(field: Field, verts: Array, faces: np.ndarray, rounds: int = 4, share: float = 0.5) -> Array:
    """Return vertices moved towards the middle of their neighbours, along the surface."""
    edges = edges_of(faces)
    both = np.vstack((edges, edges[:, ::-1]))
    count = np.bincount(both[:, 0], minlength=len(verts))
    for _ in range(rounds):
        sums = np.column_stack(
            [np.bincount(both[:, 0], verts[both[:, 1], axis], minlength=len(verts)) for axis in range(3)]
        )
        verts = onto(field, verts + share * (sums / np.maximum(count, 1)[:, None] - verts), rounds=2)
    return verts


def defects(faces: np.ndarray) -> int:
    """Return the number of edges that do not have two faces, each in its own direction."""
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return int((counts != 2).sum())


def without_fins(faces: np.ndarray) -> np.ndarray:
    """Return faces without pairs that lie on each other, back to back."""
    order = np.argsort(faces, axis=1)
    turned = np.isin(order @ (9, 3, 1), (1 * 3 + 2, 1 * 9 + 2 * 3, 2 * 9 + 1))
    _, same = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True)
    same = same.ravel()
    balance = np.bincount(same, np.where(turned, 1, -1))
    first = np.zeros(len(faces), bool)
    first[np.unique(np.column_stack((same, turned)), axis=0, return_index=True)[1]] = True
    return faces[first & (balance[same] * np.where(turned, 1, -1) > 0)]


def without_slivers(verts: Array, faces: np.ndarray, least: float) -> tuple[Array, np.ndarray]:
    """Return a mesh in which vertices that are joined by an edge shorter than *least* are one."""
    edges = edges_of(faces)
    short = edges[np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1) < least]
    pairs = coo_matrix((np.ones(len(short)), short.T), shape=(len(verts),) * 2)
    count, label = connected_components(pairs, directed=False)
    members = np.bincount(label, minlength=count)
    merged = np.column_stack([np.bincount(label, verts[:, axis], minlength=count) / members for axis in range(3)])
    joined = label[faces]
    whole = (joined[:, 0] != joined[:, 1]) & (joined[:, 1] != joined[:, 2]) & (joined[:, 2] != joined[:, 0])
    return only(merged, joined[whole], np.ones(count, bool))
