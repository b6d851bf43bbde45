"""Materials, pictures and skins of a model, and what is around the infant, for a page."""

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image
from trimesh import creation

from mimoc.base.errors import MimocError
from mimoc.base.geometry.meshes import STEP_M
from mimoc.base.mujoco_layout import LAST_VISIBLE_GROUP, SOLIDS_GROUP
from mimoc.bundle.variants import MOVING, Variant, array_of
from mimoc.viewer.encoding import Places
from mimoc.viewer.growth import IntArray, Own, own_parts

BONES = 4  # Bodies that move a vertex, at most.


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
    shown = _geoms(model, parts, solids)
    bodies = bodies_around(model, parts, solids=solids)
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


Mesh = tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]
"""Vertices in the frame of the geom, shape (n, 3), [m], and the vertices of each triangle, shape (m, 3)."""

GEOM = mujoco.mjtGeom
FINENESS = 3  # How often the faces of an icosahedron are divided for a ball: 642 vertices.


def mesh_of(model: mujoco.MjModel, geom: int) -> Mesh:
    """Return the surface of a geom; MimocError if it has none, as a plane."""
    kind = GEOM(int(model.geom_type[geom]))
    size = model.geom_size[geom]
    if kind == GEOM.mjGEOM_MESH:
        verts, faces = (rows_of(model, part, model.geom_dataid[geom]) for part in ("mesh_vert", "mesh_face"))
        return model.mesh_vert[verts].astype(float), model.mesh_face[faces].astype(np.int64)
    shape: Any
    if kind == GEOM.mjGEOM_BOX:
        shape = creation.box(2 * size)
    elif kind == GEOM.mjGEOM_CYLINDER:
        shape = creation.cylinder(size[0], 2 * size[1])
    elif kind in (GEOM.mjGEOM_SPHERE, GEOM.mjGEOM_CAPSULE, GEOM.mjGEOM_ELLIPSOID):
        shape = creation.icosphere(FINENESS)
        shape.vertices *= size if kind == GEOM.mjGEOM_ELLIPSOID else size[0]
    else:
        raise MimocError(f"the geom '{model.geom(geom).name}' has no mesh")
    vertices = np.array(shape.vertices)
    if kind == GEOM.mjGEOM_CAPSULE:  # A ball that is cut in the middle and pulled apart.
        vertices += np.sign(vertices) * (0, 0, size[1])
    return vertices, np.array(shape.faces, np.int64)


Array = npt.NDArray[Any]
Colour = tuple[int, int, int]  # Red, green and blue, 0 to 255.


@dataclass(frozen=True, slots=True)
class BoundSkin:
    """One skin as it is bound to bodies."""

    vertices_m: Array  # Shape (n, 3).
    weights: Array  # Shape (n, bodies); they sum to 1 for each vertex.
    bodies: Array  # Those that move it, shape (bodies,).
    bind_pos: Array  # Where they are when the vertices are as above, shape (bodies, 3), [m].
    bind_quat: Array  # Shape (bodies, 4).


def skin_of(model: mujoco.MjModel, index: int) -> BoundSkin:
    """Return a skin by its number."""
    verts, bones = rows_of(model, "skin_vert", index), rows_of(model, "skin_bone", index)
    weights = np.zeros((verts.stop - verts.start, bones.stop - bones.start))
    for bone in range(bones.start, bones.stop):
        rows = rows_of(model, "skin_bonevert", bone)
        weights[model.skin_bonevertid[rows], bone - bones.start] = model.skin_bonevertweight[rows]
    return BoundSkin(
        model.skin_vert[verts],
        weights / weights.sum(axis=1, keepdims=True),
        model.skin_bonebodyid[bones],
        model.skin_bonebindpos[bones],
        model.skin_bonebindquat[bones],
    )


def rows_of(model: mujoco.MjModel, kind: str, index: int) -> slice:
    """Return the rows of a mesh or a skin in the model's arrays of a kind: `mesh_vert` or `skin_bone`, say."""
    first = getattr(model, f"{kind}adr")[index]
    return slice(first, first + getattr(model, f"{kind}num")[index])


def coloured_faces(model: mujoco.MjModel, index: int, colours: int) -> Iterator[tuple[Colour, Array]]:
    """Yield the colours of a skin, at most so many, each with its faces, shape (m, 3)."""
    faces = model.skin_face[rows_of(model, "skin_face", index)]
    material = model.skin_matid[index]
    rgba = model.mat_rgba[material] if material >= 0 else model.skin_rgba[index]
    pixels = texture_of(model, material)
    first = model.skin_texcoordadr[index]
    if pixels is None or first < 0:
        yield colour_of(255 * rgba[:3]), faces
        return
    across, down = (model.skin_texcoord[first + faces].mean(axis=1) * model.mat_texrepeat[material] % 1.0).T
    height, width = pixels.shape[:2]
    seen = pixels[(down * height).astype(int), (across * width).astype(int)] * rgba[:3]
    few = Image.fromarray(seen[None].astype(np.uint8), "RGB").quantize(colours, Image.Quantize.MEDIANCUT)
    palette = np.array(few.getpalette()).reshape(-1, 3)
    chosen = np.asarray(few)[0]
    for number in np.unique(chosen).tolist():
        yield colour_of(palette[number]), faces[chosen == number]


def colour_of(rgb: Array) -> Colour:
    """Return a colour of rounded numbers."""
    red, green, blue = np.rint(rgb).astype(int).tolist()
    return red, green, blue


def texture_of(model: mujoco.MjModel, material: int) -> Array | None:
    """Return the picture of a material, shape (height, width, 3), 0 to 255; None if it has none."""
    texture = model.mat_texid[material, mujoco.mjtTextureRole.mjTEXROLE_RGB] if material >= 0 else -1
    if texture < 0:
        return None
    pixels = pixels_of(model, texture)
    return np.broadcast_to(pixels, (*pixels.shape[:2], 3)) if pixels.shape[2] == 1 else pixels[..., :3]


def pixels_of(model: mujoco.MjModel, texture: int) -> Array:
    """Return the pixels of a texture, shape (height, width, channels), 0 to 255."""
    shape = model.tex_height[texture], model.tex_width[texture], model.tex_nchannel[texture]
    first = model.tex_adr[texture]
    return model.tex_data[first : first + np.prod(shape)].reshape(shape)
