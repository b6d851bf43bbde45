"""A toy as a shape, before it gets a size, a colour and a place."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.geometry.rotations import FloatArray, Quaternion, Vec3

IntArray = npt.NDArray[np.intp]

Tint = Literal["main", "accent", "dark", "light"]
"""What colours a part: the colour drawn for the toy, one that goes with it, nearly black or nearly white."""
SolidType = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh"]

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A surface of triangles, wound so that they face outwards."""

    vertices: FloatArray
    """Shape (n, 3)."""
    faces: IntArray
    """Shape (m, 3)."""


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
    """As MuJoCo wants it (radius, then half length along z; half edges; half axes); empty for a mesh."""
    pos: Vec3 = (0.0, 0.0, 0.0)
    quat: Quaternion = UPRIGHT
    mesh: Mesh | None = None
    """The convex hull, of a mesh."""


@dataclass(frozen=True, slots=True)
class ToyModel:
    """The shape of a toy. Lengths are in units of its longest side; it stands on z = 0, centred over the origin."""

    name: str
    """Of this very object, such as `truck_003`."""
    category: str
    """Of its kind, as Toys4K has them, such as `truck`."""
    parts: tuple[Part, ...]
    """Its visible parts."""
    solids: tuple[Solid, ...]
    """Its collision shapes."""
    volume: float
    """Volume of its material."""
    density_kg_m3: float
    """Mean density of the material, hollows included."""
    source: str
    """Where it comes from, for the README of a bundle."""
