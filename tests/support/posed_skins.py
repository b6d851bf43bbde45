"""Layers of a skin in poses: where their vertices are, how long their edges, and where they pass through each other."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

from mimoc.body.kinematics import frames
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.scene import SkinLayer

NEAR_M = 0.02  # Middles of an edge and of a face that cross are nearer than this.


def edges_of(layer: SkinLayer) -> np.ndarray:
    return np.unique(np.sort(layer.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)


def posed(layer: SkinLayer, placed) -> np.ndarray:
    verts_m = np.zeros_like(layer.verts_m)
    for index, bone in enumerate(layer.bones):
        origin, turn = placed[bone]
        (moved,) = np.nonzero(layer.weights[:, index])
        carried = (layer.verts_m[moved] - layer.origins_m[index]) @ (turn @ layer.turns[index].T).T + origin
        verts_m[moved] += layer.weights[moved, index, None] * carried
    return verts_m


def lengths(verts: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    return np.linalg.norm(verts[pairs[:, 0]] - verts[pairs[:, 1]], axis=1)


def random_frames(tree: BodyTree, count: int, seed: int) -> Iterator[dict]:
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield frames(tree, {name: np.radians(rng.uniform(*joint.range_deg)) for name, joint in tree.joints.items()})


def crossings(
    verts: np.ndarray, edges: np.ndarray, other: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return which edges of one mesh pass through faces of another, and how far their nearer ends are from these."""
    near = cKDTree(verts[edges].mean(axis=1)).query_ball_tree(cKDTree(other[faces].mean(axis=1)), NEAR_M)
    edge = np.repeat(np.arange(len(edges)), [len(some) for some in near])
    face = np.fromiter((index for some in near for index in some), np.intp)
    start, end = verts[edges[edge, 0]], verts[edges[edge, 1]]
    a, b, c = (other[faces[face, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    above, below = (((point - a) * normal).sum(axis=1) for point in (start, end))
    share = above / np.where(above == below, 1, above - below)
    at = start + share[:, None] * (end - start)
    is_inside = above * below < 0
    for one, next_one in ((a, b), (b, c), (c, a)):
        is_inside &= (np.cross(next_one - one, at - one) * normal).sum(axis=1) > 0
    return edge[is_inside], np.minimum(np.abs(above), np.abs(below))[is_inside]
