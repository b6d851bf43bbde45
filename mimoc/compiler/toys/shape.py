"""The shape of a toy, before it gets a size, a colour and a position: meshes and solids, their bounds and volumes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry import primitives
from mimoc.base.geometry.primitives import Extents, Kind, extents
from mimoc.base.geometry.rotations import FloatArray, Quaternion, Vec3, matrix_from_quaternion

IntArray = npt.NDArray[np.intp]

Tint = Literal["main", "accent", "dark", "light"]
"""Colour of a part: the toy's random colour, a contrasting one, near-black or near-white."""
SolidType = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh"]

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh whose faces point outwards; its arrays become read-only."""

    vertices: FloatArray  # Shape (n, 3).
    faces: IntArray  # Shape (m, 3).

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


def centre_of(mesh: Mesh) -> FloatArray:
    """Return the centre of mass of the volume of a convex mesh, from tetrahedra between its faces and its middle."""
    middle = mesh.vertices.mean(axis=0)
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] - middle for corner in range(3))
    volumes = np.einsum("ij,ij->i", np.cross(a, b), c)
    return middle + volumes @ (a + b + c) / (4 * volumes.sum())


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
    mesh: Mesh | None = None  # The mesh, if `type` is `mesh`, whose convex hull is the solid.


@dataclass(frozen=True, slots=True)
class ToyModel:
    """The shape of a toy. Lengths are in units of its longest side; it stands on z = 0, centred over the origin."""

    name: str  # Name of the object, such as `truck_003`.
    category: str  # Category of the object, as in Toys4K, such as `truck`.
    parts: tuple[Part, ...]
    solids: tuple[Solid, ...]  # Its collision shapes.
    volume: float  # Volume that has the density below.
    density_kg_m3: float  # Mean density, including cavities.
    source: str  # Origin of the shape, for the README of a bundle.
    notes: tuple[str, ...] = ()  # Notes for the user of a bundle with this toy.


_ANGLES = np.linspace(0, math.tau, 48, endpoint=False)
_AROUND = np.stack([np.cos(_ANGLES), np.sin(_ANGLES), np.zeros(48)], axis=1)  # Horizontal directions.


def bounds(solid: Solid) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of a solid's axis-aligned bounding box."""
    at, extent = np.array(solid.pos), _extents(solid).along(matrix_from_quaternion(solid.quat)[:, None])[:, 0]
    return at - extent, at + extent


def radius(solid: Solid) -> float:
    """Return the largest distance of a solid's points from the z axis."""
    at, axes = np.array(solid.pos), matrix_from_quaternion(solid.quat)
    if solid.mesh is not None:
        return float(np.linalg.norm((at + solid.mesh.vertices @ axes.T)[:, :2], axis=1).max())
    extent = _extents(solid).along((_AROUND @ axes)[:, None])[:, 0]
    return float((_AROUND @ at + extent).max()) / math.cos(math.pi / len(_AROUND))


def solid_volume(solid: Solid) -> float:
    """Return the volume of a solid."""
    return solid.mesh.volume if solid.mesh else primitives.volume(_kind(solid), solid.size)


def _extents(solid: Solid) -> Extents:
    return extents([(_kind(solid), solid.size)])


def _kind(solid: Solid) -> Kind:
    assert solid.type != "mesh"
    return solid.type


SOURCE = "made by mimoc"

Looks = Mapping[Tint, Sequence[Mesh]]  # Visual meshes by colour.


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
    parts = tuple(Part(Mesh((mesh.vertices - origin) * scale, mesh.faces), tint) for tint, mesh in meshes.items())
    return ToyModel(
        name=category,
        category=category,
        parts=parts,
        solids=tuple(_placed(solid, scale, ground) for solid in solids),
        volume=math.fsum(part.mesh.volume for part in parts),
        density_kg_m3=density_kg_m3,
        source=SOURCE,
    )


def _placed(solid: Solid, scale: float, origin: FloatArray) -> Solid:
    x, y, z = ((solid.pos - origin) * scale).tolist()
    return replace(solid, size=tuple(scale * length for length in solid.size), pos=(x, y, z))
