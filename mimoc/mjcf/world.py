"""The world around an infant in MJCF."""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.body.tree import Vec3
from mimoc.mjcf.constraints import Lock, Pair, Weld
from mimoc.mjcf.furniture import BARE, Furniture
from mimoc.mjcf.infant import Camera
from mimoc.mjcf.lights import OUTDOORS, DirectionalLight, Headlight
from mimoc.mjcf.materials import WorldMaterial
from mimoc.mjcf.objects import FreeObject, MeshFile


@dataclass(frozen=True, slots=True)
class Ground:
    """A floor without end."""

    name: str
    height_m: float


@dataclass(frozen=True, slots=True)
class Mark:
    """A point in the world that programs place (MuJoCo's `mocap`); it touches nothing, and is hidden."""

    name: str
    pos_m: Vec3
    radius_m: float
    rgba: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class World:
    """What is around the infant."""

    infant_at: Vec3 = (0.0, 0.0, 0.0)
    """Where the infant is put: x and y, [m], and how far it is turned about the vertical, [rad]."""
    gravity_m_s2: Vec3 = (0.0, 0.0, -9.81)
    grounds: tuple[Ground, ...] = ()
    """Floors without end."""
    lights: tuple[DirectionalLight, ...] = ()
    """Those from afar."""
    headlight: Headlight = OUTDOORS
    furniture: Furniture = BARE
    toys: tuple[FreeObject, ...] = ()
    apparatus: tuple[FreeObject, ...] = ()
    """What a task needs."""
    locks: tuple[Lock, ...] = ()
    welds: tuple[Weld, ...] = ()
    cameras: tuple[Camera, ...] = ()
    """Onlookers'."""
    marks: tuple[Mark, ...] = ()
    pairs: tuple[Pair, ...] = ()
    """Contacts with what is barred, such as walls."""

    @property
    def props(self) -> tuple[FreeObject, ...]:
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
