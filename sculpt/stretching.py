"""How much skin is stretched in random poses, and weights that let it stretch less."""

import numpy as np
from fields import Array
from meshing import edges_of
from resting import child
from weights import quantized

from mimoc.body.kinematics import frames
from mimoc.looks.skin.deformation import layers_of
from mimoc.looks.skin.template_mesh import LAYERS, Sculpture
from mimoc.mjcf.skin import SkinLayer

AGES_MONTHS = (0.0, 9.0, 24.0)
POSES = 80
MOST = 3.2
"""Stretch of an edge, relative to the pose that it is bound in, beyond which its ends are moved more alike."""


def stretches(sculpted: Sculpture, hands: str) -> dict[str, Array]:
    """Return how many times longer each edge gets in random poses at several ages, by layer."""
    rng = np.random.default_rng(99)
    edges = {name: edges_of(sculpted.layers[name].faces) for name in LAYERS}
    most = {name: np.ones(len(edges[name])) for name in LAYERS}
    for age_months in AGES_MONTHS:
        tree = child(hands, age_months)
        layers = {layer.name: layer for layer in layers_of(tree, sculpted)}
        usual = {name: _lengths(layers[name].verts_m, edges[name]) for name in LAYERS}
        for _ in range(POSES):
            angles = {name: np.radians(rng.uniform(*joint.range_deg)) for name, joint in tree.joints.items()}
            placed = frames(tree, angles)
            for name in LAYERS:
                longer = _lengths(_posed(layers[name], placed), edges[name]) / usual[name]
                most[name] = np.maximum(most[name], longer)
    return most


def eased(own: Array, twins: np.ndarray, faces: np.ndarray, stretch: Array) -> Array:
    """Return weights of which those at the ends of stretched edges are more alike."""
    found, edges = own.copy(), edges_of(faces)
    for a, b in edges[stretch > MOST]:
        found[a] = found[b] = (found[a] + found[b]) / 2
    ends = np.unique(edges[stretch > MOST])
    both = np.vstack((edges, edges[:, ::-1]))
    total = np.zeros_like(own)
    np.add.at(total, both[:, 0], own[both[:, 1]])
    around = total / np.maximum(total.sum(axis=1, keepdims=True), 1e-9)
    found[ends] = (found[ends] + around[ends]) / 2
    return quantized(found[twins])


def _posed(layer: SkinLayer, placed) -> Array:
    found = np.zeros_like(layer.verts_m)
    for index, bone in enumerate(layer.bones):
        (moved,) = np.nonzero(layer.weights[:, index])
        origin, turn = placed[bone]
        own = (layer.verts_m[moved] - layer.origins_m[index]) @ (turn @ layer.turns[index].T).T + origin
        found[moved] += layer.weights[moved, index, None] * own
    return found


def _lengths(verts: Array, edges: np.ndarray) -> Array:
    return np.maximum(np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1), 1e-9)
