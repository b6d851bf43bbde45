"""How much skin is stretched in random poses, and weights that let it stretch less."""

from collections.abc import Sequence

import numpy as np
from fields import Array
from meshing import edges_of
from resting import child, posed
from weights import symmetric

from mimoc.body.kinematics import frames
from mimoc.looks.skin.deformation import layers_of
from mimoc.looks.skin.template_mesh import Sculpture

AGES_MONTHS = (0.0, 9.0, 24.0)
POSES = 80
MOST = 2.1
"""Stretch of an edge, relative to the pose that it is bound in, beyond which its ends are moved more alike."""


def stretches(sculpted: Sculpture, hands: str) -> tuple[np.ndarray, Array]:
    """Return the edges of the bare body, and how many times longer each gets in random poses at several ages."""
    rng = np.random.default_rng(99)
    edges = edges_of(sculpted.mesh.faces)
    most = np.ones(len(edges))
    for age_months in AGES_MONTHS:
        tree = child(hands, age_months)
        bare = layers_of(tree, sculpted)[0]
        usual = _lengths(bare.verts_m, edges)
        for _ in range(POSES):
            angles = {name: np.radians(rng.uniform(*joint.range_deg)) for name, joint in tree.joints.items()}
            most = np.maximum(most, _lengths(posed(bare, frames(tree, angles)), edges) / usual)
    return edges, most


def eased(held: Array, edges: np.ndarray, stretch: Array, twins: np.ndarray, names: Sequence[str]) -> Array:
    """Return weights of which those at the ends of stretched edges are more alike."""
    eased_ones, far = held.copy(), edges[stretch > MOST]
    for a, b in far:
        eased_ones[a] = eased_ones[b] = (eased_ones[a] + eased_ones[b]) / 2
    ends = np.unique(far)
    both = np.vstack((edges, edges[:, ::-1]))
    total = np.zeros_like(held)
    np.add.at(total, both[:, 0], held[both[:, 1]])
    around = total / np.maximum(total.sum(axis=1, keepdims=True), 1e-9)
    eased_ones[ends] = (eased_ones[ends] + around[ends]) / 2
    return symmetric(eased_ones, twins, names)


def _lengths(verts: Array, edges: np.ndarray) -> Array:
    return np.maximum(np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1), 1e-9)
