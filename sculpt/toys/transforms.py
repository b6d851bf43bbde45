"""Transforms of meshes: moving, scaling, turning, mirroring and flattening."""

import math
from typing import Literal

import numpy as np

from mimoc.base.geometry.rotations import Vec3, matrix_from_axis
from mimoc.compiler.toys.shape import Mesh


def move(mesh: Mesh, by: Vec3) -> Mesh:
    """Return a mesh moved by a vector."""
    return Mesh(mesh.vertices + by, mesh.faces)


def stretch(mesh: Mesh, factors: Vec3) -> Mesh:
    """Return a mesh scaled along x, y and z."""
    return Mesh(mesh.vertices * factors, mesh.faces)


def turn(mesh: Mesh, axis: Literal["x", "y", "z"], angle_deg: float) -> Mesh:
    """Return a mesh turned about an axis through the origin by the right-hand rule."""
    rotation = matrix_from_axis(np.eye(3)["xyz".index(axis)], math.radians(angle_deg))
    return Mesh(mesh.vertices @ rotation.T, mesh.faces)


def mirror(mesh: Mesh) -> Mesh:
    """Return a mesh mirrored at the plane y = 0."""
    return Mesh(mesh.vertices * (1.0, -1.0, 1.0), mesh.faces[:, ::-1])


def pair(mesh: Mesh) -> tuple[Mesh, Mesh]:
    """Return a mesh and its mirror image at the plane y = 0."""
    return mesh, mirror(mesh)


def flatten_below(mesh: Mesh, floor: float = 0.0) -> Mesh:
    """Return a mesh whose vertices below a height are moved up to it."""
    return Mesh(np.maximum(mesh.vertices, (-np.inf, -np.inf, floor)), mesh.faces)
