"""How much skin is stretched in random poses, and weights that let it stretch less."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from embedding import Curve, Drawn, placed
from fields import Array, Field
from meshing import edges_of
from resting import child, posed
from scipy.sparse import coo_matrix
from weights import symmetric

from mimoc.body.kinematics import frames
from mimoc.compiler.looks.skin.deformation import layers_of
from mimoc.compiler.looks.skin.template_mesh import Sculpture

AGES_MONTHS = (0.0, 9.0, 24.0)
POSES = 300
MOST = 1.9
"""Stretch of an edge, relative to the pose that it is bound in, beyond which its ends are moved more alike."""

RINGS, SMOOTHINGS = 3, 2
"""How many edges around them weights are smoothed, and how often."""
SPACED, SPACING, LEAST = 2.25, 0.07, 0.75
"""Stretch beyond which the ends of edges are moved apart, by what share, and how short others may get."""


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
    """Return weights that are smoother around stretched edges: more so where these are stretched more."""
    both = np.vstack((edges, edges[:, ::-1]))
    excess = np.clip(stretch / MOST - 1, 0, 0.5)
    share = np.zeros(len(held))
    np.maximum.at(share, both[:, 0], np.where(excess > 0, 0.3 + excess, 0).repeat(2).reshape(-1, 2).T.ravel())
    for _ in range(RINGS):
        wider = share.copy()
        np.maximum.at(wider, both[:, 0], 0.75 * share[both[:, 1]])
        share = wider
    average = coo_matrix((np.ones(len(both)), both.T), shape=(len(held),) * 2).tocsr()
    count = np.asarray(average.sum(axis=1))
    for _ in range(SMOOTHINGS):
        held = held + share[:, None] * (average @ held / count - held)
    return symmetric(held, twins, names)


def spaced(surface: Field, drawn: Drawn, curves: Sequence[Curve], edges: np.ndarray, stretch: Array) -> Drawn:
    """Return a symmetric mesh in which the ends of stretched edges are farther apart, on the surface and on curves."""
    verts = drawn.verts.copy()
    for a, b in edges[stretch > SPACED]:
        apart = SPACING * (verts[b] - verts[a])
        verts[a], verts[b] = verts[a] - apart, verts[b] + apart
    right = drawn.twins >= np.arange(len(verts))
    verts[right] = placed(surface, curves, verts[right], drawn.lies_on[right])
    left = ~right
    verts[left] = verts[drawn.twins[left]] * (1, -1, 1)
    short = edges[_lengths(verts, edges) < LEAST * _lengths(drawn.verts, edges)].ravel()
    kept = np.concatenate((short, drawn.twins[short]))
    verts[kept] = drawn.verts[kept]
    return replace(drawn, verts=verts)


def _lengths(verts: Array, edges: np.ndarray) -> Array:
    return np.maximum(np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1), 1e-9)
