"""Meshes of geoms and skins of a model, for what draws neither MuJoCo's shapes nor textures."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image
from trimesh import creation

from mimoc.base.errors import MimocError

Mesh = tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]
"""Vertices in the frame of the geom, shape (n, 3), [m], and the vertices of each triangle, shape (m, 3)."""

GEOM = mujoco.mjtGeom
FINENESS = 3
"""How often the faces of an icosahedron are divided for a ball: 642 vertices."""


def mesh_of(model: mujoco.MjModel, geom: int) -> Mesh:
    """Return the surface of a geom; MimocError if it has none, as a plane."""
    kind, size = GEOM(int(model.geom_type[geom])), model.geom_size[geom]
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
Colour = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""


@dataclass(frozen=True, slots=True)
class BoundSkin:
    """One skin as it is bound to bodies."""

    vertices_m: Array
    """Shape (n, 3)."""
    weights: Array
    """Shape (n, bodies); they sum to 1 for each vertex."""
    bodies: Array
    """Those that move it, shape (bodies,)."""
    bind_pos: Array
    """Where they are when the vertices are as above, shape (bodies, 3), [m]."""
    bind_quat: Array
    """Shape (bodies, 4)."""


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
    faces, material = model.skin_face[rows_of(model, "skin_face", index)], model.skin_matid[index]
    rgba = model.mat_rgba[material] if material >= 0 else model.skin_rgba[index]
    pixels, first = texture_of(model, material), model.skin_texcoordadr[index]
    if pixels is None or first < 0:
        yield colour_of(255 * rgba[:3]), faces
        return
    across, down = (model.skin_texcoord[first + faces].mean(axis=1) * model.mat_texrepeat[material] % 1.0).T
    height, width = pixels.shape[:2]
    seen = pixels[(down * height).astype(int), (across * width).astype(int)] * rgba[:3]
    few = Image.fromarray(seen[None].astype(np.uint8), "RGB").quantize(colours, Image.Quantize.MEDIANCUT)
    palette, chosen = np.array(few.getpalette()).reshape(-1, 3), np.asarray(few)[0]
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
