"""Meshes of MuJoCo's geoms, for what cannot draw their shapes itself."""

import mujoco
import numpy as np
import numpy.typing as npt
from trimesh import creation

from mimoc.errors import MimocError

Mesh = tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]
"""Vertices in the frame of the geom, shape (n, 3), [m], and the vertices of each triangle, shape (m, 3)."""

GEOM = mujoco.mjtGeom
FINENESS = 3
"""How often the faces of an icosahedron are divided for a ball: 642 vertices."""


def mesh_of(model: mujoco.MjModel, geom: int) -> Mesh:
    """Return the surface of a geom.

    Raises:
        MimocError: If it has none, as a plane.
    """
    kind, size = GEOM(int(model.geom_type[geom])), model.geom_size[geom]
    if kind == GEOM.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        first, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
        vertices_m = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
        return vertices_m.astype(float), model.mesh_face[face : face + model.mesh_facenum[mesh]].astype(np.int64)
    if kind == GEOM.mjGEOM_BOX:
        shape = creation.box(2 * size)
    elif kind == GEOM.mjGEOM_CYLINDER:
        shape = creation.cylinder(size[0], 2 * size[1])
    elif kind in (GEOM.mjGEOM_SPHERE, GEOM.mjGEOM_CAPSULE, GEOM.mjGEOM_ELLIPSOID):
        shape = creation.icosphere(FINENESS)
    else:
        raise MimocError(f"the geom '{model.geom(geom).name}' has no mesh")
    vertices = np.array(shape.vertices)
    if kind == GEOM.mjGEOM_ELLIPSOID:
        vertices = vertices * size
    elif kind == GEOM.mjGEOM_SPHERE:
        vertices = vertices * size[0]
    elif kind == GEOM.mjGEOM_CAPSULE:  # A ball that is cut in the middle and pulled apart.
        vertices = vertices * size[0] + np.sign(vertices) * (0, 0, size[1])
    return vertices, np.array(shape.faces, np.int64)
