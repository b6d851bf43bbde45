"""The world around an infant in MJCF: what moves in it, and its constraints, locks, welds and listed contacts.

MuJoCo looks for contacts between two bodies in a tree of boxes as soon as one of them has several geoms. The world is
one body, the boxes of planes are infinite, and so the tree of a whole room costs 5 to 8 % of a physics step and finds
nothing. A listed pair bypasses the tree and costs a hundredth of a microsecond; contact bits of zero keep walls out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.elements import Camera, Node, PrintedGeom
from mimoc.mjcf.furniture import BARE, OUTDOORS, SOLID, DirectionalLight, Furniture, Headlight, WorldGeom, WorldMaterial


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


@dataclass(frozen=True, slots=True)
class Lock:
    """A constraint that keeps a hinge at an angle."""

    name: str
    joint: str
    angle_rad: float
    active: bool
    """Whether it is active from the start; others can be switched on."""


@dataclass(frozen=True, slots=True)
class Weld:
    """A constraint that fixes a part of the infant in the world."""

    name: str
    body: str
    anchor_m: Vec3
    """The point that is fixed, in the frame of the body."""
    pos_m: Vec3
    """Where that point is in the world."""
    quat: tuple[float, float, float, float]
    torquescale: float
    """1 fixes the orientation; 0 leaves it free about the point."""


@dataclass(frozen=True, slots=True)
class Pair:
    """Two geoms that collide although their contact bits say otherwise."""

    geom1: str
    geom2: str
    condim: int
    friction: tuple[float, float, float, float, float]
    """Sliding along two axes, spinning, and rolling about two axes."""
    solref: tuple[float, float]
    solimp: tuple[float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Ground:
    """An endless floor."""

    name: str
    height_m: float


@dataclass(frozen=True, slots=True)
class Mark:
    """A marker that programs move (a MuJoCo mocap body); it touches nothing, and is hidden."""

    name: str
    pos_m: Vec3
    radius_m: float
    rgba: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class World:
    """What is around the infant."""

    gravity_m_s2: Vec3 = (0.0, 0.0, -9.81)
    grounds: tuple[Ground, ...] = ()
    lights: tuple[DirectionalLight, ...] = ()
    headlight: Headlight = OUTDOORS
    furniture: Furniture = BARE
    objects: tuple[FreeObject, ...] = ()
    """What moves besides the infant."""
    locks: tuple[Lock, ...] = ()
    welds: tuple[Weld, ...] = ()
    cameras: tuple[Camera, ...] = ()
    """Cameras that are fixed to the world."""
    marks: tuple[Mark, ...] = ()
    pairs: tuple[Pair, ...] = ()
    """Contacts with barriers, such as walls."""

    @property
    def plain_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials of one colour."""
        return (*self.furniture.plain_materials, *(material for item in self.objects for material in item.materials))

    @property
    def meshes(self) -> tuple[MeshFile, ...]:
        """The meshes of all objects."""
        return tuple(mesh for item in self.objects for mesh in item.meshes)

    @property
    def assets(self) -> Mapping[str, bytes]:
        """Binary files by path in the bundle."""
        return {texture.file: texture.content for texture in (*self.furniture.textures, *self.meshes)}


def barrier_pairs(world: World, roots: Sequence[Node]) -> tuple[Pair, ...]:
    """Return the contacts of barriers with an infant and with whatever else moves, as if contact bits allowed them."""
    of_infant = (geom for root in roots for node in root.subtree() for geom in node.geoms)
    of_objects = (geom for item in world.objects for geom in item.geoms)
    moving = [geom for geom in (*of_infant, *of_objects) if SOLID & (geom.contype | geom.conaffinity)]
    barriers = (geom for geom in world.furniture.geoms if geom.barrier)
    return tuple(_pair(barrier, geom) for barrier in barriers for geom in moving)


def _pair(barrier: WorldGeom, geom: PrintedGeom | ObjectGeom) -> Pair:
    """Return a contact with what MuJoCo mixes of two geoms that are equally soft, or takes of one with priority."""
    settings: Mapping[str, Any] = dict(geom.settings) if isinstance(geom, PrintedGeom) else {}
    decisive = (geom,) if "priority" in settings else (barrier, geom)
    sliding, spinning, rolling = map(max, zip(*(side.friction for side in decisive), strict=True))
    return Pair(
        geom1=barrier.name,
        geom2=geom.name,
        condim=max(side.condim for side in decisive),
        friction=(sliding, sliding, spinning, rolling, rolling),
        solref=settings.get("solref", barrier.solref),
        solimp=settings.get("solimp", barrier.solimp),
    )
