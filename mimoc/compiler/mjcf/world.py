"""The world around an infant in MJCF: what moves in it, and its constraints, locks, welds and listed contacts.

MuJoCo looks for contacts between two bodies in a tree of boxes as soon as one of them has several geoms. The world is
one body, the boxes of planes are infinite, and so the tree of a whole room costs 5 to 8 % of a physics step and finds
nothing. A listed pair bypasses the tree and costs a hundredth of a microsecond; contact bits of zero keep walls out.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from mimoc.base.geometry.rotations import Quaternion, Vec3
from mimoc.body.tree import Geom
from mimoc.compiler.mjcf.elements import (
    BARE,
    OUTDOORS,
    SOLID,
    Camera,
    DirectionalLight,
    Furniture,
    HasMaterials,
    Headlight,
    Node,
    Site,
    WorldGeom,
    WorldMaterial,
    WorldTexture,
)


@dataclass(frozen=True, slots=True)
class MeshFile:
    """The triangles of a mesh."""

    name: str
    file: str  # Path inside the bundle.
    content: bytes  # An OBJ.
    inertia: str  # How MuJoCo computes its volume: `shell` for a mesh that is only seen and may be open, or `convex`.


@dataclass(frozen=True, slots=True)
class ObjectGeom:
    """A primitive or a mesh of an object."""

    name: str
    type: str
    material: str
    sizes: tuple[tuple[str, tuple[float, ...]], ...] = ()  # The size of a primitive, as an attribute.
    names: tuple[tuple[str, str], ...] = ()  # The name of its mesh, if it is one, as an attribute.
    pos_m: Vec3 = (0.0, 0.0, 0.0)
    quat: Quaternion = (1.0, 0.0, 0.0, 0.0)
    mass_kg: float = 0.0
    contype: int = SOLID
    conaffinity: int = SOLID
    condim: int = 3
    friction: Vec3 = (1.0, 0.005, 0.0005)
    solmix: float = 1.0
    group: int = 0
    solref: tuple[float, float] = (0.005, 1.0)
    solimp: tuple[float, float, float, float, float] = (0.95, 0.99, 0.001, 0.5, 1.0)


@dataclass(frozen=True, slots=True)
class ObjectJoint:
    """A joint of an object, other than a free one."""

    name: str
    type: Literal["ball", "hinge", "slide"]
    damping: float  # In N m s/rad, or of a slide in N s/m.
    axis: Vec3 = (0.0, 0.0, 1.0)
    pos_m: Vec3 = (0.0, 0.0, 0.0)
    limited: bool = False
    range: tuple[float, float] = (0.0, 0.0)  # In [rad], or of a slide in [m]; of a ball, 0 and the largest angle.
    stiffness: float = 0.0
    frictionloss: float = 0.0
    armature: float = 0.0

    @property
    def qpos(self) -> tuple[float, ...]:
        """Where it is at rest."""
        return (1.0, 0.0, 0.0, 0.0) if self.type == "ball" else (0.0,)


@dataclass(frozen=True, slots=True)
class ObjectBody:
    """A body of an object, with those that hang on it; the outermost has its place in the world."""

    name: str
    pos_m: Vec3 = (0.0, 0.0, 0.0)
    quat: Quaternion = (1.0, 0.0, 0.0, 0.0)
    free_joints: tuple[str, ...] = ()  # The name of its free joint, if it is the outermost body and has one.
    joints: tuple[ObjectJoint, ...] = ()
    geoms: tuple[ObjectGeom, ...] = ()
    sites: tuple[Site, ...] = ()
    children: tuple["ObjectBody", ...] = ()

    def subtree(self) -> Iterator["ObjectBody"]:
        """Yield this body and its descendants, each before its children."""
        yield self
        for child in self.children:
            yield from child.subtree()

    @property
    def qpos(self) -> tuple[float, ...]:
        """The part of a keyframe that is its, at rest."""
        numbers = list[float]()
        for body in self.subtree():
            numbers += (*body.pos_m, *body.quat) if body.free_joints else ()
            numbers += (number for joint in body.joints for number in joint.qpos)
        return tuple(numbers)


@dataclass(frozen=True, slots=True)
class Ribbon:
    """A spatial tendon of limited length: straight, it pulls at both of its ends; slack, at none."""

    name: str
    sites: tuple[str, ...]  # Along its way.
    range_m: tuple[float, float]  # 0, and its length.
    rgba: tuple[float, float, float, float]
    width_m: float = 0.0015
    stiffness_n_per_m: float = 0.0
    damping_ns_per_m: float = 0.0


@dataclass(frozen=True, slots=True)
class PlacedObject:
    """An object at its place: all of it that stands in the MJCF."""

    root: ObjectBody
    materials: tuple[WorldMaterial, ...]
    meshes: tuple[MeshFile, ...] = ()
    ribbons: tuple[Ribbon, ...] = ()


@dataclass(frozen=True, slots=True)
class FreeObject:
    """An object that moves freely."""

    name: str
    object: str  # What it is, such as `truck_003`.
    category: str  # Its kind, such as `truck`.
    source: str  # Where its shape comes from.
    joint: str
    pos_m: Vec3
    quat: tuple[float, float, float, float]
    size_m: float  # Its longest side.
    mass_kg: float
    density_kg_m3: float  # Mean density, hollows included.
    geoms: tuple[ObjectGeom, ...]
    materials: tuple[WorldMaterial, ...]
    meshes: tuple[MeshFile, ...]
    notes: tuple[str, ...] = ()  # What is to be known of its shape, for the README of a bundle.


@dataclass(frozen=True, slots=True)
class Lock:
    """A constraint that keeps a hinge at an angle."""

    name: str
    joint: str
    angle_rad: float
    active: bool  # Whether it is active from the start; others can be switched on.


@dataclass(frozen=True, slots=True)
class Weld:
    """A constraint that fixes a part of the infant in the world."""

    name: str
    body: str
    anchor_m: Vec3  # The point that is fixed, in the frame of the body.
    pos_m: Vec3  # Where that point is in the world.
    quat: tuple[float, float, float, float]
    torquescale: float  # 1 fixes the orientation; 0 leaves it free about the point.


@dataclass(frozen=True, slots=True)
class Pair:
    """Two geoms that collide although their contact bits say otherwise."""

    geom1: str
    geom2: str
    condim: int
    friction: tuple[float, float, float, float, float]  # Sliding along two axes, spinning, and rolling about two axes.
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
class Grip:
    """A weld that is switched off, by which a body that programs move can hold another."""

    name: str
    holder: str
    held: str  # The body that is held unless a program names another.


@dataclass(frozen=True)
class Persona(HasMaterials):
    """Somebody besides the infant: bodies that programs move (mocap bodies of MuJoCo)."""

    bodies: tuple[ObjectBody, ...] = ()
    materials: tuple[WorldMaterial, ...] = ()
    textures: tuple[WorldTexture, ...] = ()  # Cubes of six sides.
    grips: tuple[Grip, ...] = ()


NOBODY = Persona()  # No one but the infant.


@dataclass(frozen=True, slots=True)
class World:
    """What is around the infant."""

    gravity_m_s2: Vec3 = (0.0, 0.0, -9.81)
    grounds: tuple[Ground, ...] = ()
    lights: tuple[DirectionalLight, ...] = ()
    headlight: Headlight = OUTDOORS
    furniture: Furniture = BARE
    objects: tuple[FreeObject, ...] = ()  # Toys, and what a task adds, each a single body that moves freely.
    placed: tuple[PlacedObject, ...] = ()  # The objects of the spec.
    locks: tuple[Lock, ...] = ()
    welds: tuple[Weld, ...] = ()
    cameras: tuple[Camera, ...] = ()  # Cameras that are fixed to the world.
    marks: tuple[Mark, ...] = ()
    pairs: tuple[Pair, ...] = ()  # Contacts with barriers, such as walls.
    persona: Persona = NOBODY

    @property
    def plain_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials of one colour."""
        items = (*self.objects, *self.placed)
        of_items = (material for item in items for material in item.materials)
        return (*self.furniture.plain_materials, *of_items, *self.persona.plain_materials)

    @property
    def meshes(self) -> tuple[MeshFile, ...]:
        """The meshes of all objects."""
        return tuple(mesh for item in (*self.objects, *self.placed) for mesh in item.meshes)

    @property
    def placed_roots(self) -> tuple[ObjectBody, ...]:
        """The outermost bodies of the spec's objects."""
        return tuple(item.root for item in self.placed)

    @property
    def ribbons(self) -> tuple[tuple[Ribbon, ...], ...]:
        """All ribbons together, once; nothing if there is none."""
        ribbons = tuple(ribbon for item in self.placed for ribbon in item.ribbons)
        return (ribbons,) if ribbons else ()

    @property
    def resting(self) -> tuple[float, ...]:
        """The part of a keyframe that comes after the infant's (qpos): everything that moves, at rest."""
        free = (number for item in self.objects for number in (*item.pos_m, *item.quat))
        return (*free, *(number for root in self.placed_roots for number in root.qpos))

    @property
    def assets(self) -> Mapping[str, bytes]:
        """Binary files by path in the bundle."""
        files = (*self.furniture.textures, *self.persona.textures, *self.meshes)
        return {file.file: file.content for file in files}


def barrier_pairs(world: World, roots: Sequence[Node]) -> tuple[Pair, ...]:
    """Return the contacts of barriers with an infant and with whatever else moves, as if contact bits allowed them."""
    of_infant = (geom for root in roots for node in root.subtree() for geom in node.geoms)
    bodies = (*world.objects, *(body for root in world.placed_roots for body in root.subtree()))
    of_objects = (geom for body in bodies for geom in body.geoms)
    moving = [geom for geom in (*of_infant, *of_objects) if SOLID & (geom.contype | geom.conaffinity)]
    barriers = (geom for geom in world.furniture.geoms if geom.barrier)
    return tuple(_pair(barrier, geom) for barrier in barriers for geom in moving)


def _pair(barrier: WorldGeom, geom: Geom | ObjectGeom) -> Pair:
    """Return a contact with what MuJoCo mixes of two geoms that are equally soft, or takes of one with priority."""
    settings: Mapping[str, Any] = dict(geom.settings) if isinstance(geom, Geom) else {}
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
