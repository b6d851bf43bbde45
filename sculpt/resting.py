"""Where the skin rests on the floor: it is pressed flat, so that one sees contact where it is."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from mimoc.body.head_surface import head_radius
from mimoc.body.kinematics import frames_in_world
from mimoc.body.poses import POSES, poses_of, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.building import builder
from mimoc.looks.skin.deformation import layers_of
from mimoc.looks.skin.template_mesh import LAYERS, Sculpture
from mimoc.mjcf.skin import SkinLayer
from mimoc.schema.infant import InfantSpec

AGES_MONTHS = (0.0, 4.0, 9.0, 24.0)
ALLOWED_M = 0.0006
"""How far the skin may be below the floor."""


@cache
def child(hands: str, age_months: float) -> BodyTree:
    """Return the body of an average child."""
    spec = {"mimoc": 1, "name": "child", "age_months": age_months, "body": {"hands": hands}}
    return builder(InfantSpec.model_validate(spec), skin=False).tree


def pressed(sculpted: Sculpture, hands: str) -> Mapping[str, Any]:
    """Return how the vertices of each layer move so that no age sinks into the floor in any resting pose, [m]."""
    total = {name: np.zeros_like(sculpted.layers[name].verts_m) for name in LAYERS}
    for age_months in AGES_MONTHS:
        tree = child(hands, age_months)
        layers = {layer.name: layer for layer in layers_of(tree, sculpted)}
        for pose in POSES:
            placed = frames_in_world(tree, resting_state(tree, poses_of(tree)[pose]))
            for name in LAYERS:
                move = _lifted(layers[name], placed) * (sculpted.head_radius_m / head_radius(tree.geoms["head"]))
                larger = np.linalg.norm(move, axis=1) > np.linalg.norm(total[name], axis=1)
                total[name][larger] = move[larger]
    return total


def _lifted(layer: SkinLayer, placed: Mapping[str, Any]) -> Any:
    """Return how far each vertex has to move, in the pose that it is bound in, to be on the floor in another pose."""
    verts = np.zeros_like(layer.verts_m)
    up = np.zeros_like(layer.verts_m)
    for index, bone in enumerate(layer.bones):
        origin, turn = placed[bone]
        from_bind = turn @ layer.turns[index].T
        share = layer.weights[:, index : index + 1]
        verts += share * ((layer.verts_m - layer.origins_m[index]) @ from_bind.T + origin)
        up += share * from_bind[2]
    deep = np.clip(-ALLOWED_M - verts[:, 2], 0, 0.02)
    return deep[:, None] * up / np.maximum(np.linalg.norm(up, axis=1, keepdims=True) ** 2, 0.3)
