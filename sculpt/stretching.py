"""Where the skin rests on the floor, pressed flat; and weights that let it stretch less in random poses."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from cutting import Curve, Drawn, placed
from fields import Array, Field
from meshing import edges_of
from scipy.sparse import coo_matrix
from weights import symmetric

from mimoc.body.kinematics import Frame, frames, frames_in_world
from mimoc.body.poses import POSES, poses_of, resting_state
from mimoc.body.tree import BodyTree, head_radius
from mimoc.compiler.building import builder
from mimoc.compiler.looks.sculpture import BARE, Sculpture
from mimoc.compiler.looks.skin import layers_of
from mimoc.compiler.mjcf.scene import SkinLayer
from mimoc.schema.infant import InfantSpec

ALLOWED_MM = 0.6  # How far the skin may be below the floor.


@cache
def child(hands: str, age_months: float) -> BodyTree:
    """Return the body of an average child without clothes."""
    spec = {"mimoc": 1, "name": "child", "age_months": age_months, "body": {"hands": hands}}
    return replace(builder(InfantSpec.model_validate(spec), skin=False).tree, clothes=BARE)


def pressed(sculpted: Sculpture, hands: str, soft_mm: Array) -> tuple[np.ndarray, Array]:
    """Return fullness that lets no age sink into the floor in any resting pose, and how much room there is below.

    Args:
        sculpted: The skin as it is.
        hands: Its kind of hands.
        soft_mm: How much farther than the rest each vertex may sink.

    Returns:
        Fullness at each age that is sculpted, as it ships, and the least height of each vertex, [mm].
    """
    fullness_mm, room_mm = 1000 * sculpted.fullness_m, np.full(len(sculpted.mesh.verts_m), 99.0)
    for index, age_months in enumerate(sculpted.ages_months):
        tree = child(hands, age_months)
        bare = layers_of(tree, sculpted)[0]
        size = head_radius(tree.geoms["head"]) / sculpted.head_radius_m
        height_mm = np.full(len(bare.verts_m), 99.0)
        for pose in POSES:
            placed = frames_in_world(tree, resting_state(tree, poses_of(tree)[pose]))
            height_mm = np.minimum(height_mm, 1000 * posed(bare, placed)[:, 2])
        fullness_mm[index] -= np.clip(-ALLOWED_MM - soft_mm - height_mm, 0, 20) / size
        room_mm = np.minimum(room_mm, height_mm)
    return np.rint(10 * fullness_mm).clip(-127, 127).astype(np.int8), room_mm


def posed(layer: SkinLayer, placed: Mapping[str, Frame]) -> Array:
    """Return where bodies take the vertices of a layer, as MuJoCo does it."""
    verts_m = np.zeros_like(layer.verts_m)
    for index, bone in enumerate(layer.bones):
        (moved,) = np.nonzero(layer.weights[:, index])
        origin, turn = placed[bone]
        carried = (layer.verts_m[moved] - layer.origins_m[index]) @ (turn @ layer.turns[index].T).T + origin
        verts_m[moved] += layer.weights[moved, index, None] * carried
    return verts_m


AGES_MONTHS = (0.0, 9.0, 24.0)
RANDOM_POSES = 300
MAX_STRETCH = (
    1.9  # Stretch of an edge, relative to the pose that it is bound in, beyond which its ends are moved more alike.
)

RINGS, SMOOTHINGS = 3, 2  # How many edges around them weights are smoothed, and how often.
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
        for _ in range(RANDOM_POSES):
            angles = {name: np.radians(rng.uniform(*joint.range_deg)) for name, joint in tree.joints.items()}
            most = np.maximum(most, _lengths(posed(bare, frames(tree, angles)), edges) / usual)
    return edges, most


def eased(held: Array, edges: np.ndarray, stretch: Array, twins: np.ndarray, names: Sequence[str]) -> Array:
    """Return weights that are smoother around stretched edges: more so where these are stretched more."""
    both = np.vstack((edges, edges[:, ::-1]))
    excess = np.clip(stretch / MAX_STRETCH - 1, 0, 0.5)
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
