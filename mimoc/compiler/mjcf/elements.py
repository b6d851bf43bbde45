"""The elements of MJCF besides the joints, geoms and tendons of a body: SI units, angles in radians, all decided."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from mimoc.base.geometry.rotations import Vec3
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import stature
from mimoc.body.tree import Attributes, BodyTree, Geom, Joint


@dataclass(frozen=True, slots=True)
class Site:
    """A marked point of a body."""

    name: str
    pos_m: Vec3
    radius_m: float
    settings: Attributes = ()


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera: an eye, or one that watches."""

    name: str
    pos_m: Vec3
    euler_rad: Vec3
    fovy_deg: float
    names: tuple[tuple[str, str], ...] = ()  # What it follows, if it follows anything, as attributes.


@dataclass(frozen=True, slots=True)
class Node:
    """A body with all that is attached to it."""

    name: str
    pos_m: Vec3
    euler_deg: Vec3
    free_joints: tuple[str, ...] = ()
    joints: tuple[Joint, ...] = ()
    geoms: tuple[Geom, ...] = ()
    sites: tuple[Site, ...] = ()
    cameras: tuple[Camera, ...] = ()
    children: tuple["Node", ...] = ()

    def subtree(self) -> Iterator["Node"]:
        """Yield this body and its descendants, each before its children."""
        yield self
        for child in self.children:
            yield from child.subtree()


@dataclass(frozen=True, slots=True)
class Actuator:
    """An actuator of a joint."""

    name: str
    mimo_actuator: str  # The actuator of MIMo that it corresponds to, alone or with others.
    joint: str
    gear: float
    control_range: tuple[float, float]
    settings: Attributes
    tone: tuple[float, ...] = ()
    """What a quiet infant's muscle tone adds, in proportion to arousal: to the three numbers of `biasprm`, or, as two
    numbers, to the stiffness of its hinge and to stiffness x rest angle. Empty is no tone."""


@dataclass(frozen=True, slots=True)
class PassiveActuator:
    """An actuator of a joint that takes no commands: its torque is its bias, within its force range."""

    name: str
    joint: str
    bias: tuple[float, ...]  # Torque at angle and speed 0, and by angle and speed.
    force_range: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Sensor:
    """A MuJoCo sensor at a site."""

    kind: str
    name: str
    site: str


Rgba = tuple[float, float, float, float]  # Red, green, blue and opacity, 0 to 1.

UNTINTED: Rgba = (1.0, 1.0, 1.0, 1.0)  # MuJoCo multiplies a texture by its material's colour.


@dataclass(frozen=True, slots=True)
class WorldTexture:
    """One `<texture>`, a flat one or a cube of six sides.

    Only planes and skins have flat ones: on all other shapes MuJoCo 3.5 and 3.17 map them differently.
    """

    name: str
    file: str  # Path inside the bundle.
    content: bytes  # The PNG; its top is up on a wall.


@dataclass(frozen=True, slots=True)
class WorldMaterial:
    """One `<material>`, with `texuniform="false"` if it has a texture."""

    name: str
    rgba: Rgba  # Colour, or what the texture is multiplied by.
    texture: str | None = None
    texrepeat: tuple[float, float] = (1.0, 1.0)
    """How often the texture repeats across the whole plane, rightwards and upwards."""
    specular: float = 0.1
    shininess: float = 0.1
    reflectance: float = 0.0
    emission: float = 0.0


class HasMaterials:
    """Something with materials, which the templates print by whether they have a texture."""

    materials: tuple[WorldMaterial, ...]

    @property
    def textured_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials with a texture."""
        return tuple(material for material in self.materials if material.texture)

    @property
    def plain_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials of one colour."""
        return tuple(material for material in self.materials if not material.texture)


@dataclass(frozen=True, slots=True)
class PrintedSkin:
    """One `<skin>`: a mesh that several bodies move, seen but not felt."""

    name: str
    file: str  # Path inside the bundle.
    material: str


@dataclass(frozen=True)
class Appearance(HasMaterials):
    """The textures and materials of an infant, in the order they are written."""

    textures: tuple[WorldTexture, ...]  # The cubes.
    materials: tuple[WorldMaterial, ...]
    flat_textures: tuple[WorldTexture, ...] = ()  # Those of skins.
    skins: tuple[PrintedSkin, ...] = ()  # In the order they are drawn, too.

    @property
    def assets(self) -> Mapping[str, bytes]:
        """The PNGs by path inside the bundle."""
        return {texture.file: texture.content for texture in (*self.textures, *self.flat_textures)}


@dataclass(frozen=True, slots=True)
class DirectionalLight:
    """A directional light."""

    name: str
    pos_m: Vec3
    direction: Vec3
    diffuse: Vec3
    castshadow: bool


@dataclass(frozen=True, slots=True)
class SpotLight:
    """One `<light type="spot">`."""

    name: str
    pos_m: Vec3
    direction: Vec3
    diffuse: Vec3
    specular: Vec3
    attenuation: Vec3  # Constant, linear and quadratic.
    cutoff_deg: float  # In degrees even where the compiler's angles are radians.
    exponent: float
    castshadow: bool


@dataclass(frozen=True, slots=True)
class Headlight:
    """MuJoCo's light at the camera, under `<visual>`."""

    ambient: Vec3  # From all directions.
    diffuse: Vec3  # From the camera: little, or walls get brighter when a head turns to them.


OUTDOORS = Headlight((0.43, 0.43, 0.43), (0.24, 0.24, 0.24))
"""Beside the sun; all three together just do not overexpose skin."""


UNTOUCHED = 0  # Contact bits of geoms that are only seen.
SOLID = 1
DOMINANT_SOLMIX = 100.0
"""`solmix` of a geom whose softness decides that of its contacts with an infant; two of them share."""


@dataclass(frozen=True, slots=True)
class WorldGeom:
    """One `<geom>` that is fixed to the world."""

    name: str
    type: str
    size_m: tuple[float, ...]  # As MuJoCo wants it.
    pos_m: Vec3
    euler_rad: Vec3  # About x, y and z in turn, each as the former left it: `eulerseq="xyz"`.
    material: str
    contype: int = SOLID
    conaffinity: int = SOLID
    condim: int = 3
    friction: Vec3 = (1.0, 0.005, 0.0002)
    solref: tuple[float, float] = (0.005, 1.0)
    solimp: tuple[float, float, float, float, float] = (0.95, 0.99, 0.001, 0.5, 1.0)
    solmix: float = 1.0  # Weight of its softness in that of a contact; an infant's geoms have 1.
    group: int = 0
    barrier: bool = False  # Whether contacts with it are listed pairs instead of contact bits; see `barrier_pairs`.


def untouched(geom: WorldGeom) -> WorldGeom:
    """Return a geom that is only seen, or touched by listed pairs alone."""
    return replace(geom, contype=UNTOUCHED, conaffinity=UNTOUCHED)


@dataclass(frozen=True)
class Furniture(HasMaterials):
    """Things that are fixed to the world, with their materials, textures and lights."""

    geoms: tuple[WorldGeom, ...] = ()
    materials: tuple[WorldMaterial, ...] = ()
    textures: tuple[WorldTexture, ...] = ()
    lights: tuple[SpotLight, ...] = ()

    def __add__(self, other: "Furniture") -> "Furniture":
        return Furniture(
            self.geoms + other.geoms,
            self.materials + other.materials,
            self.textures + other.textures,
            self.lights + other.lights,
        )


BARE = Furniture()  # No furniture.


RAIL_IN_CHILDREN = 0.43 / 0.82
"""Height of a rail's middle above the ground, for one length of the child: at 18 months, 0.82 m long, MIMo
holds it at 0.42 to 0.45 m."""
RAIL_RADIUS_M = 0.01  # A hand closes around it: its girth is 6 cm, a newborn's hand is 6 cm long.


def rail_height(tree: BodyTree) -> float:
    """Return how high the middle of a rail for this child is, in [m]."""
    return RAIL_IN_CHILDREN * cm_to_m(stature(tree)["length_cm"])
