"""What stands around an infant, as MJCF lists it: SI units, angles in radians, every value decided."""

from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3
from mimoc.looks.appearance import Rgba

UNTOUCHED = 0
"""Contact bits of what only shows."""
SOLID = 1
FIRM = 100.0
"""`solmix` of a mattress, and of toys: an infant is as soft as these are, and the two of them share."""


@dataclass(frozen=True, slots=True)
class WorldTexture:
    """One `<texture type="2d">`.

    Only planes wear it: on all other shapes MuJoCo 3.5 and 3.17 lay it in different ways.
    """

    name: str
    file: str
    """Path inside the bundle."""
    content: bytes
    """The PNG; its top is up on a wall."""


@dataclass(frozen=True, slots=True)
class WorldMaterial:
    """One `<material>`, with `texuniform="false"` if it has a texture."""

    name: str
    rgba: Rgba
    """Colour, or what the texture is multiplied by."""
    texture: str | None = None
    texrepeat: tuple[float, float] = (1.0, 1.0)
    """How often the texture repeats across the whole plane that wears it, rightwards and upwards."""
    specular: float = 0.1
    shininess: float = 0.1
    reflectance: float = 0.0
    emission: float = 0.0
    """How much it shines by itself, 0 to 1."""


@dataclass(frozen=True, slots=True)
class WorldGeom:
    """One `<geom>` that is fixed to the world."""

    name: str
    type: str
    size_m: tuple[float, ...]
    """As MuJoCo wants it."""
    pos_m: Vec3
    euler_rad: Vec3
    """About x, y and z in turn, each as the former left it: `eulerseq="xyz"`."""
    material: str
    contype: int = SOLID
    conaffinity: int = SOLID
    condim: int = 3
    friction: Vec3 = (1.0, 0.005, 0.0002)
    solref: tuple[float, float] = (0.005, 1.0)
    solimp: tuple[float, float, float, float, float] = (0.95, 0.99, 0.001, 0.5, 1.0)
    solmix: float = 1.0
    """How much it counts for how soft a contact is; an infant's geoms count 1."""
    group: int = 0
    barrier: bool = False
    """Whether what moves touches it by a pair for each of its geoms, and not by contact bits; see `pairs.py`."""


@dataclass(frozen=True, slots=True)
class WorldLight:
    """One `<light type="spot">`."""

    name: str
    pos_m: Vec3
    direction: Vec3
    diffuse: Vec3
    specular: Vec3
    attenuation: Vec3
    """Constant, linear and quadratic."""
    cutoff_deg: float
    """MuJoCo wants it in degrees, whatever its compiler says of angles."""
    exponent: float
    castshadow: bool


@dataclass(frozen=True, slots=True)
class Headlight:
    """MuJoCo's light that goes with the camera, under `<visual>`."""

    ambient: Vec3
    """From everywhere."""
    diffuse: Vec3
    """From the camera: little, or walls get brighter when a head turns to them."""


@dataclass(frozen=True, slots=True)
class Furniture:
    """Some things and all that their looks need."""

    geoms: tuple[WorldGeom, ...] = ()
    materials: tuple[WorldMaterial, ...] = ()
    textures: tuple[WorldTexture, ...] = ()
    lights: tuple[WorldLight, ...] = ()

    def __add__(self, other: "Furniture") -> "Furniture":
        """Return the things of both."""
        return Furniture(
            self.geoms + other.geoms,
            self.materials + other.materials,
            self.textures + other.textures,
            self.lights + other.lights,
        )

    @property
    def textured_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials with a texture."""
        return tuple(material for material in self.materials if material.texture)

    @property
    def plain_materials(self) -> tuple[WorldMaterial, ...]:
        """Materials of one colour."""
        return tuple(material for material in self.materials if not material.texture)


BARE = Furniture()
"""Nothing at all."""
