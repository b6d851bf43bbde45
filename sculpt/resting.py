"""Where the skin rests on the floor: it is pressed flat, so that one sees contact where it is."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
from fields import Array

from mimoc.body.head_surface import head_radius
from mimoc.body.kinematics import Frame, frames_in_world
from mimoc.body.poses import POSES, poses_of, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.building import builder
from mimoc.compiler.looks.skin.deformation import layers_of
from mimoc.compiler.looks.skin.garments import BARE
from mimoc.compiler.looks.skin.template_mesh import Sculpture
from mimoc.compiler.mjcf.skin import SkinLayer
from mimoc.schema.infant import InfantSpec

ALLOWED_MM = 0.6
"""How far the skin may be below the floor."""


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
