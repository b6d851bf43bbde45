"""Materials, pictures and skins of a model, and what is around the infant, for a page."""

import io
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.geometry.face_steps import STEP_M
from mimoc.base.mujoco_layout import LAST_VISIBLE_GROUP, SOLIDS_GROUP
from mimoc.bundle.face import MOVING, array_of
from mimoc.bundle.variants import Variant
from mimoc.viewer.encoding import Places
from mimoc.viewer.growth import IntArray, Own, own_parts
from mimoc.viewer.meshes import pixels_of, rows_of, skin_of

BONES = 4
"""Bodies that move a vertex, at most."""


def describe_materials(model: mujoco.MjModel) -> dict[str, Any]:
    """Return the materials of a model and their pictures as PNGs; those of a cube are six, one below the other."""
    textures = model.mat_texid[:, mujoco.mjtTextureRole.mjTEXROLE_RGB]
    used = sorted({int(texture) for texture in textures if texture >= 0})
    return {
        "materials": [
            {
                "name": model.mat(index).name,
                "rgba": model.mat_rgba[index].tolist(),
                "texture": used.index(textures[index]) if textures[index] >= 0 else None,
                "repeat": model.mat_texrepeat[index].tolist(),
            }
            for index in range(model.nmat)
        ],
        "textures": [
            {"cube": bool(model.tex_type[index] == mujoco.mjtTexture.mjTEXTURE_CUBE), "png": _png(model, index)}
            for index in used
        ],
    }


def _png(model: mujoco.MjModel, index: int) -> bytes:
    pixels, file = pixels_of(model, index), io.BytesIO()
    Image.fromarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels).save(file, "PNG", compress_level=9)
    return file.getvalue()


def describe_skins(variants: Sequence[Variant], ages_months: Sequence[float]) -> dict[str, Any] | None:
    """Return the skins of an infant at some ages, which have the same vertices at each; None if it has none."""
    models = [variant.model for variant in variants]
    if not models[0].nskin:
        return None
    bodies = own_parts(models[0], variants[0].bundle.manifest).bodies.tolist()
    return {
        "ages_months": list(ages_months),
        "layers": [_layer(models, index, bodies) for index in range(models[0].nskin)],
    }


def describe_face(variants: Sequence[Variant], ages_months: Sequence[float]) -> dict[str, Any] | None:
    """Return how expressions move the skin of an infant's head at some ages; None if they do not."""
    faces = [variant.bundle.manifest.face for variant in variants]
    first = faces[0]
    if first is None or first.skin is None or not first.shapes:
        return None
    arrays = [variant.bundle.arrays for variant in variants]
    moving = np.unique(np.concatenate([of_age[MOVING] for of_age in arrays]))
    moves = {name: np.zeros((len(arrays), len(moving), 3)) for name in first.shapes}
    for age, of_age in enumerate(arrays):
        rows = np.searchsorted(moving, of_age[MOVING])
        for name in first.shapes:
            moves[name][age, rows] = STEP_M * of_age[array_of(name)]
    return {
        "ages_months": list(ages_months),
        "layer": first.skin,
        "begins": first.begins,
        "moving": moving.astype(np.uint32),
        "moves": {name: Places(offsets_m) for name, offsets_m in moves.items()},
    }


def _layer(models: Sequence[mujoco.MjModel], index: int, bodies: list[int]) -> dict[str, Any]:
    model = models[0]
    verts, faces, bones = (rows_of(model, kind, index) for kind in ("skin_vert", "skin_face", "skin_bone"))
    moved_by, weights = _strongest(skin_of(model, index).weights)
    return {
        "name": model.skin(index).name,
        "material": int(model.skin_matid[index]),
        "faces": model.skin_face[faces].astype(np.uint32),
        "texcoords": _texcoords(models, index),
        "bones": np.array([bodies.index(body) for body in model.skin_bonebodyid[bones]]),
        "moved_by": moved_by.astype(np.uint8),
        "weights": weights,
        "verts": Places(np.stack([variant.skin_vert[verts] for variant in models])),
        "bind_pos": np.stack([variant.skin_bonebindpos[bones] for variant in models]),
        "bind_quat": np.stack([variant.skin_bonebindquat[bones] for variant in models]),
    }


def _texcoords(models: Sequence[mujoco.MjModel], index: int) -> npt.NDArray[Any] | None:
    """Return where a skin is painted, shape (n, 2), or by age (ages, n, 2), as hair that grows is; None if nowhere."""
    first = models[0].skin_texcoordadr[index]
    if first < 0:
        return None
    by_age = np.stack([model.skin_texcoord[first : first + model.skin_vertnum[index]] for model in models])
    return by_age if np.ptp(by_age, axis=0).any() else by_age[0]


def _strongest(weights: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Return the bones that move each vertex most, as numbers within the skin, and their weights, shapes (n, 4).

    Weights are bytes whose sum is 255 for each vertex: where it is not, a vertex is pulled towards the origin.
    """
    width = max(BONES, weights.shape[1])
    weights = np.pad(weights, ((0, 0), (0, width - weights.shape[1])))
    order = np.argsort(-weights, axis=1, kind="stable")[:, :BONES]
    chosen = np.take_along_axis(weights, order, 1)
    shares = np.rint(255 * chosen / chosen.sum(axis=1, keepdims=True)).astype(int)
    shares[:, 0] += 255 - shares.sum(axis=1)
    return order, shares.astype(np.uint8)


def describe_surroundings(
    model: mujoco.MjModel, data: mujoco.MjData, parts: Own, *, solids: bool = False
) -> dict[str, Any]:
    """Return the geoms that are not the infant's *parts*, with their bodies where they are now.

    With *solids*, those of other infants under their skins are there as well.
    """
    shown, bodies = _geoms(model, parts, solids), bodies_around(model, parts, solids=solids)
    mesh_of_geom = model.geom_dataid[shown]
    meshes = np.unique(mesh_of_geom[model.geom_type[shown] == mujoco.mjtGeom.mjGEOM_MESH])
    return {
        "bodies": {
            "names": [model.body(body).name for body in bodies],
            "pos": data.xpos[bodies],
            "quat": data.xquat[bodies],
        },
        "geoms": {
            "names": [model.geom(geom).name for geom in shown],
            "body": np.searchsorted(bodies, model.geom_bodyid[shown]),
            "type": model.geom_type[shown],
            "material": model.geom_matid[shown],
            "mesh": np.where(np.isin(mesh_of_geom, meshes), np.searchsorted(meshes, mesh_of_geom), -1),
            "rgba": np.where(model.geom_matid[shown, None] >= 0, 1.0, model.geom_rgba[shown]),
            "pos": model.geom_pos[shown],
            "quat": model.geom_quat[shown],
            "size": model.geom_size[shown],
        },
        "meshes": [
            {
                "verts": model.mesh_vert[rows_of(model, "mesh_vert", mesh)],
                "faces": model.mesh_face[rows_of(model, "mesh_face", mesh)].astype(np.uint32),
            }
            for mesh in meshes.tolist()
        ],
    }


def bodies_around(model: mujoco.MjModel, parts: Own, *, solids: bool = False) -> IntArray:
    """Return the bodies with geoms that are not the infant's, sorted; see `describe_surroundings`."""
    return np.unique(model.geom_bodyid[_geoms(model, parts, solids)])


def _geoms(model: mujoco.MjModel, parts: Own, solids: bool) -> IntArray:
    shown = (model.geom_group <= LAST_VISIBLE_GROUP) | (solids & (model.geom_group == SOLIDS_GROUP))
    return np.setdiff1d(np.flatnonzero(shown), parts.geoms)
