"""Objects in MJCF that move freely."""

from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.materials import WorldMaterial


@dataclass(frozen=True, slots=True)
class MeshFile:
    """The triangles of a mesh."""

    name: str
    file: str
    """Path inside the bundle."""
    content: bytes
    """An OBJ."""
    inertia: str
    """How MuJoCo computes its volume: `shell` for a mesh that is only seen and may be open, or `convex`."""


@dataclass(frozen=True, slots=True)
class ObjectGeom:
    """A primitive or a mesh of an object."""

    name: str
    type: str
    names: tuple[tuple[str, str], ...]
    """The name of its mesh, if it is one, as an attribute."""
    sizes: tuple[tuple[str, tuple[float, ...]], ...]
    """The size of a primitive, as an attribute."""
    pos_m: Vec3
    quat: tuple[float, float, float, float]
    mass_kg: float
    material: str
    contype: int
    conaffinity: int
    condim: int
    friction: Vec3
    solmix: float
    group: int


@dataclass(frozen=True, slots=True)
class FreeObject:
    """An object that moves freely."""

    name: str
    object: str
    """What it is, such as `truck_003`."""
    category: str
    """Its kind, such as `truck`."""
    source: str
    """Where its shape comes from."""
    joint: str
    pos_m: Vec3
    quat: tuple[float, float, float, float]
    size_m: float
    """Its longest side."""
    mass_kg: float
    density_kg_m3: float
    """Mean density, hollows included."""
    geoms: tuple[ObjectGeom, ...]
    materials: tuple[WorldMaterial, ...]
    meshes: tuple[MeshFile, ...]
