"""What is around an infant, such as furniture and toys, for a page."""

from typing import Any

import mujoco
import numpy as np

from mimoc.mujoco_layout import LAST_VISIBLE_GROUP
from mimoc.viewer.growth import IntArray, Own
from mimoc.viewer.packing import EncodedArrays


def describe_surroundings(
    packed: EncodedArrays, model: mujoco.MjModel, data: mujoco.MjData, parts: Own
) -> dict[str, Any]:
    """Return the geoms that are not the infant's, with their bodies where they are now.

    Args:
        packed: Where the arrays go.
        model: The model.
        data: Its state, with what is derived from it.
        parts: What is the infant's.
    """
    shown, bodies = _geoms(model, parts), bodies_around(model, parts)
    meshes = np.unique(model.geom_dataid[shown][model.geom_type[shown] == mujoco.mjtGeom.mjGEOM_MESH])
    rgba = np.where(model.geom_matid[shown, None] >= 0, 1.0, model.geom_rgba[shown])
    return {
        "bodies": {
            "names": [model.body(body).name for body in bodies],
            "pos": packed.put(data.xpos[bodies]),
            "quat": packed.put(data.xquat[bodies]),
        },
        "geoms": {
            "names": [model.geom(geom).name for geom in shown],
            "body": packed.put(np.searchsorted(bodies, model.geom_bodyid[shown])),
            "type": packed.put(model.geom_type[shown]),
            "material": packed.put(model.geom_matid[shown]),
            "mesh": packed.put(
                np.where(
                    np.isin(model.geom_dataid[shown], meshes), np.searchsorted(meshes, model.geom_dataid[shown]), -1
                )
            ),
            "rgba": packed.put(rgba),
            "pos": packed.put(model.geom_pos[shown]),
            "quat": packed.put(model.geom_quat[shown]),
            "size": packed.put(model.geom_size[shown]),
        },
        "meshes": [_mesh(packed, model, int(mesh)) for mesh in meshes],
    }


def bodies_around(model: mujoco.MjModel, parts: Own) -> IntArray:
    """Return the bodies with geoms that are not the infant's, sorted."""
    return np.unique(model.geom_bodyid[_geoms(model, parts)])


def _geoms(model: mujoco.MjModel, parts: Own) -> IntArray:
    return np.setdiff1d(np.flatnonzero(model.geom_group <= LAST_VISIBLE_GROUP), parts.geoms)


def _mesh(packed: EncodedArrays, model: mujoco.MjModel, index: int) -> dict[str, Any]:
    first, face = model.mesh_vertadr[index], model.mesh_faceadr[index]
    return {
        "verts": packed.put(model.mesh_vert[first : first + model.mesh_vertnum[index]]),
        "faces": packed.put(model.mesh_face[face : face + model.mesh_facenum[index]].astype(np.uint32)),
    }
