"""Assembly of a toy of unit size on the ground from meshes and solids of any scale."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mimoc.geometry.rotations import Vec3
from mimoc.toys.model import FloatArray, Mesh, Part, Solid, Tint, ToyModel, bounds, join

SOURCE = "made by mimoc"

Looks = Mapping[Tint, Sequence[Mesh]]
"""Visual meshes by colour."""


def assemble(category: str, looks: Looks, solids: Sequence[Solid], density_kg_m3: float) -> ToyModel:
    """Return a toy whose longest side is 1, which stands on z = 0 and is centred over the origin.

    Visual meshes and solids are placed on the ground separately, since faceted meshes may end slightly above round
    solids.

    Args:
        category: Category of Toys4K, which is also the name of the toy.
        looks: Closed meshes; where they overlap, the volume counts twice.
        solids: Collision shapes.
        density_kg_m3: Mean density, including cavities.
    """
    meshes: dict[Tint, Mesh] = {tint: join(shells) for tint, shells in looks.items()}
    vertices = np.concatenate([mesh.vertices for mesh in meshes.values()])
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    scale = 1 / float((high - low).max())
    origin = np.array([*(low + high)[:2] / 2, low[2]])
    ground = np.array([*origin[:2], min(bounds(solid)[0][2] for solid in solids)])
    parts = tuple(Part(_sized(mesh, scale, origin), tint) for tint, mesh in meshes.items())
    return ToyModel(
        name=category,
        category=category,
        parts=parts,
        solids=tuple(_placed(solid, scale, ground) for solid in solids),
        volume=math.fsum(part.mesh.volume for part in parts),
        density_kg_m3=density_kg_m3,
        source=SOURCE,
    )


def _sized(mesh: Mesh, scale: float, origin: FloatArray) -> Mesh:
    return Mesh((mesh.vertices - origin) * scale, mesh.faces)


def _placed(solid: Solid, scale: float, origin: FloatArray) -> Solid:
    x, y, z = ((solid.pos - origin) * scale).tolist()
    pos: Vec3 = (x, y, z)
    return replace(solid, size=tuple(scale * length for length in solid.size), pos=pos)
