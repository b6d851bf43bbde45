"""A scene as the templates print it: SI units, angles in radians, every value decided."""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3
from mimoc.looks.appearance import Appearance, Material
from mimoc.mjcf.furniture import BARE, Furniture, Headlight, WorldMaterial


@dataclass(frozen=True, slots=True)
class Solver:
    """MuJoCo's options for the physics; `benchmarks/solver.py` shows why these."""

    timestep_s: float
    integrator: str
    cone: str = "elliptic"
    jacobian: str = "sparse"
    solver: str = "Newton"
    iterations: int = 100
    ls_iterations: int = 50
    tolerance: float = 1e-13


@dataclass(frozen=True, slots=True)
class PrintedJoint:
    """A hinge."""

    name: str
    axis: Vec3
    pos_m: Vec3
    range_rad: tuple[float, float]
    stiffness_nm_per_rad: float
    damping_nms_per_rad: float
    frictionloss_nm: float
    armature_kgm2: float
    springref_rad: float


@dataclass(frozen=True, slots=True)
class PrintedGeom:
    """A solid of the infant."""

    name: str
    type: str
    size_m: tuple[float, ...]
    pos_m: Vec3
    euler_rad: Vec3
    mass_kg: float
    material: str
    friction: Vec3
    contype: int
    conaffinity: int
    condim: int
    group: int
    """0 for the body, 1 for what only shows."""


@dataclass(frozen=True, slots=True)
class Site:
    """A marked point of a body."""

    name: str
    pos_m: Vec3
    radius_m: float
    settings: tuple[tuple[str, tuple[float, ...]], ...] = ()
    """Its other attributes."""


@dataclass(frozen=True, slots=True)
class Camera:
    """An eye's, or an onlooker's, camera."""

    name: str
    pos_m: Vec3
    euler_rad: Vec3
    fovy_deg: float
    names: tuple[tuple[str, str], ...] = ()
    """What it follows, if it follows anything, as attributes."""


@dataclass(frozen=True, slots=True)
class Node:
    """A body with all that is fixed to it."""

    name: str
    pos_m: Vec3
    euler_rad: Vec3
    free_joints: tuple[str, ...]
    joints: tuple[PrintedJoint, ...]
    geoms: tuple[PrintedGeom, ...]
    sites: tuple[Site, ...]
    cameras: tuple[Camera, ...]
    children: tuple["Node", ...]


@dataclass(frozen=True, slots=True)
class Actuator:
    """What moves a joint."""

    name: str
    mimo_actuator: str
    """The actuator of MIMo that it stands for, alone or with others."""
    joint: str
    gear: float
    control_range: tuple[float, float]
    settings: tuple[tuple[str, tuple[float, ...]], ...]
    """Its other attributes."""


@dataclass(frozen=True, slots=True)
class PrintedTendon:
    """A fixed tendon."""

    name: str
    range_rad: tuple[float, float]
    coefficients: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class Sensor:
    """A MuJoCo sensor at a site."""

    kind: str
    name: str
    site: str


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A whole state to start from."""

    name: str
    qpos: tuple[float, ...]
    settings: tuple[tuple[str, tuple[float, ...]], ...] = ()
    """Its other attributes."""


@dataclass(frozen=True, slots=True)
class Lock:
    """A constraint that keeps a hinge at an angle."""

    name: str
    joint: str
    angle_rad: float
    active: bool
    """Whether it does so from the start; others are there to be switched on."""


@dataclass(frozen=True, slots=True)
class Weld:
    """A constraint that keeps a part of the infant where it is in the world."""

    name: str
    body: str
    anchor_m: Vec3
    """The point that is kept, in the frame of the body."""
    pos_m: Vec3
    """Where that point is kept."""
    quat: tuple[float, float, float, float]
    """How it is turned."""
    torquescale: float
    """1 to keep how it is turned; 0 lets it turn about the point."""


@dataclass(frozen=True, slots=True)
class Pair:
    """Two geoms that touch though their contact bits say that they do not."""

    geom1: str
    geom2: str
    condim: int
    friction: tuple[float, float, float, float, float]
    """Sliding along two axes, spinning, and rolling about two axes."""
    solref: tuple[float, float]
    solimp: tuple[float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Ground:
    """A floor without end."""

    name: str
    height_m: float


@dataclass(frozen=True, slots=True)
class Light:
    """A directional light."""

    name: str
    pos_m: Vec3
    direction: Vec3
    diffuse: Vec3
    castshadow: bool


@dataclass(frozen=True, slots=True)
class Mark:
    """A point in the world that programs place (MuJoCo's `mocap`); it touches nothing, and is hidden."""

    name: str
    pos_m: Vec3
    radius_m: float
    rgba: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class MeshFile:
    """The triangles of a mesh."""

    name: str
    file: str
    """Path inside the bundle."""
    content: bytes
    """An OBJ."""
    inertia: str
    """How MuJoCo is to reckon its volume: `shell` for what only shows and may be open, or `convex`."""


@dataclass(frozen=True, slots=True)
class PropGeom:
    """A primitive or a mesh of a toy."""

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
class Prop:
    """A toy, which moves freely."""

    name: str
    object: str
    """What it is, such as `truck_003`."""
    category: str
    source: str
    """Where its shape comes from."""
    joint: str
    pos_m: Vec3
    quat: tuple[float, float, float, float]
    size_m: float
    """Its longest side."""
    mass_kg: float
    density_kg_m3: float
    """Of its material, with whatever hollows it has."""
    geoms: tuple[PropGeom, ...]
    materials: tuple[WorldMaterial, ...]
    meshes: tuple[MeshFile, ...]


OUTDOORS = Headlight((0.43, 0.43, 0.43), (0.24, 0.24, 0.24))
"""Beside the sun; all three together are just not too bright for skin."""


@dataclass(frozen=True, slots=True)
class World:
    """What is around the infant."""

    infant_at: Vec3 = (0.0, 0.0, 0.0)
    """Where the infant is put: x and y, [m], and how far it is turned about the vertical, [rad]."""
    gravity_m_s2: Vec3 = (0.0, 0.0, -9.81)
    grounds: tuple[Ground, ...] = ()
    """Floors without end."""
    lights: tuple[Light, ...] = ()
    """Those from afar."""
    headlight: Headlight = OUTDOORS
    furniture: Furniture = BARE
    toys: tuple[Prop, ...] = ()
    apparatus: tuple[Prop, ...] = ()
    """What a task needs."""
    locks: tuple[Lock, ...] = ()
    welds: tuple[Weld, ...] = ()
    cameras: tuple[Camera, ...] = ()
    """Onlookers'."""
    marks: tuple[Mark, ...] = ()
    pairs: tuple[Pair, ...] = ()
    """Contacts with what is barred, such as walls."""

    @property
    def props(self) -> tuple[Prop, ...]:
        """All that moves besides the infant."""
        return (*self.toys, *self.apparatus)

    @property
    def plain_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials of one colour."""
        return (*self.furniture.plain_materials, *(material for prop in self.props for material in prop.materials))

    @property
    def meshes(self) -> tuple[MeshFile, ...]:
        """The triangles of all toys."""
        return tuple(mesh for prop in self.props for mesh in prop.meshes)

    @property
    def assets(self) -> Mapping[str, bytes]:
        """Binary files by path in the bundle."""
        return {each.file: each.content for each in (*self.furniture.textures, *self.meshes)}


@dataclass(frozen=True, slots=True)
class SceneTree:
    """An infant in its world, ready to print."""

    name: str
    solver: Solver
    roots: tuple[Node, ...]
    """The infant's hip, with everything that hangs on it."""
    appearance: Appearance
    tendons: tuple[PrintedTendon, ...]
    frictionless: tuple[tuple[str, str], ...]
    excluded: tuple[tuple[str, str], ...]
    actuator_defaults: tuple[tuple[str, str], ...]
    """Attributes that all actuators have in common."""
    actuators: tuple[Actuator, ...]
    sensors: tuple[Sensor, ...]
    world: World
    keyframes: tuple[Keyframe, ...]

    @property
    def textured_materials(self) -> tuple[Material, ...]:
        """Materials with a texture."""
        return tuple(material for material in self.appearance.materials if material.texture)

    @property
    def plain_materials(self) -> tuple[Material, ...]:
        """Materials of one colour."""
        return tuple(material for material in self.appearance.materials if not material.texture)
