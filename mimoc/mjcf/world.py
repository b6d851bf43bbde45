"""The world around an infant in MJCF."""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.constraints import Lock, Pair, Weld
from mimoc.mjcf.furniture import BARE, OUTDOORS, DirectionalLight, Furniture, Headlight
from mimoc.mjcf.infant import Camera
from mimoc.mjcf.materials import WorldMaterial
from mimoc.mjcf.objects import FreeObject, MeshFile


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
    """Endless floors."""
    lights: tuple[DirectionalLight, ...] = ()
    """Directional lights."""
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
