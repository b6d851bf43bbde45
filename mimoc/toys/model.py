"""The shape of a toy, before it gets a size, a colour and a position."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.geometry.rotations import FloatArray, Quaternion, Vec3

IntArray = npt.NDArray[np.intp]

Tint = Literal["main", "accent", "dark", "light"]
"""Colour of a part: the toy's random colour, a contrasting one, near-black or near-white."""
SolidType = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh"]

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh whose faces point outwards; its arrays become read-only."""

    vertices: FloatArray
    """Shape (n, 3)."""
    faces: IntArray
    """Shape (m, 3)."""

    def __post_init__(self) -> None:
        self.vertices.flags.writeable = self.faces.flags.writeable = False

    @property
    def volume(self) -> float:
        """Volume inside a closed mesh; where shells overlap, it counts once for each shell."""
        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6)


def join(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes joined into one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


@dataclass(frozen=True, slots=True)
class Part:
    """A visible part of a toy."""

    mesh: Mesh
    tint: Tint = "main"


@dataclass(frozen=True, slots=True)
class Solid:
    """A convex collision shape of a toy."""

    type: SolidType
    size: tuple[float, ...]
    """Size as in MuJoCo (radius, then half length along z; half edges; half axes); empty for a mesh."""
    pos: Vec3 = (0.0, 0.0, 0.0)
    quat: Quaternion = UPRIGHT
    mesh: Mesh | None = None
    """The mesh, if `type` is `mesh`, whose convex hull is the solid."""


@dataclass(frozen=True, slots=True)
class ToyModel:
    """The shape of a toy. Lengths are in units of its longest side; it stands on z = 0, centred over the origin."""

    name: str
    """Name of the object, such as `truck_003`."""
    category: str
    """Category of the object, as in Toys4K, such as `truck`."""
    parts: tuple[Part, ...]
    """Its visible parts."""
    solids: tuple[Solid, ...]
    """Its collision shapes."""
    volume: float
    """Volume that has the density below."""
    density_kg_m3: float
    """Mean density, including cavities."""
    source: str
    """Origin of the shape, for the README of a bundle."""
