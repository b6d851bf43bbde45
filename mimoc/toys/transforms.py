"""Transforms of meshes: moving, scaling, turning, mirroring, flattening and joining."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from mimoc.geometry.rotations import FloatArray, Vec3, matrix_from_axis
from mimoc.toys.model import IntArray, Mesh


def join(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes joined into one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
    return frozen_mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def move(mesh: Mesh, by: Vec3) -> Mesh:
    """Return a mesh moved by a vector."""
    return frozen_mesh(mesh.vertices + by, mesh.faces)


def stretch(mesh: Mesh, factors: Vec3) -> Mesh:
    """Return a mesh scaled along x, y and z."""
    return frozen_mesh(mesh.vertices * factors, mesh.faces)


def turn(mesh: Mesh, axis: Literal["x", "y", "z"], angle_deg: float) -> Mesh:
    """Return a mesh turned about an axis through the origin by the right-hand rule."""
    rotation = matrix_from_axis(np.eye(3)["xyz".index(axis)], math.radians(angle_deg))
    return frozen_mesh(mesh.vertices @ rotation.T, mesh.faces)


def mirror(mesh: Mesh) -> Mesh:
    """Return a mesh mirrored at the plane y = 0."""
    return frozen_mesh(mesh.vertices * (1.0, -1.0, 1.0), mesh.faces[:, ::-1])


def pair(mesh: Mesh) -> tuple[Mesh, Mesh]:
    """Return a mesh and its mirror image at the plane y = 0."""
    return mesh, mirror(mesh)


def flatten_below(mesh: Mesh, floor: float = 0.0) -> Mesh:
    """Return a mesh whose vertices below a height are moved up to it."""
    return frozen_mesh(np.maximum(mesh.vertices, (-np.inf, -np.inf, floor)), mesh.faces)


def mesh_volume(mesh: Mesh) -> float:
    """Return the volume inside a closed mesh; where shells overlap, it counts once for each shell."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6)


def frozen_mesh(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return a mesh whose arrays are read-only."""
    vertices.flags.writeable = faces.flags.writeable = False
    return Mesh(vertices, faces)
