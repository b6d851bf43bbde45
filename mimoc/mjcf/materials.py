"""Materials and textures in MJCF: those of the world, and those of the infant."""

from collections.abc import Mapping
from dataclasses import dataclass

Rgba = tuple[float, float, float, float]
"""Red, green, blue and opacity, 0 to 1."""

UNTINTED: Rgba = (1.0, 1.0, 1.0, 1.0)
"""MuJoCo multiplies a texture by its material's colour."""


@dataclass(frozen=True, slots=True)
class WorldTexture:
    """One `<texture type="2d">`.

    Only planes have it: on all other shapes MuJoCo 3.5 and 3.17 map it differently.
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
    """How often the texture repeats across the whole plane, rightwards and upwards."""
    specular: float = 0.1
    shininess: float = 0.1
    reflectance: float = 0.0
    emission: float = 0.0
    """Emission of light, 0 to 1."""


@dataclass(frozen=True, slots=True)
class Texture:
    """One cube `<texture>`, all six sides in one file (2D ones look different on capsules in MuJoCo 3.5 and 3.17)."""

    name: str
    """Name that a material refers to."""
    file: str
    """Path inside the bundle, a key of `Appearance.assets`."""
    gridsize: str
    """Rows and columns of the cube's grid."""
    gridlayout: str
    """MuJoCo's letter for each cell, row by row."""


@dataclass(frozen=True, slots=True)
class Material:
    """One `<material>`; every attribute is written out, so that no MuJoCo default matters."""

    name: str
    """Name that a geom refers to."""
    rgba: Rgba
    """Colour, or what the texture is multiplied by; 0 to 1."""
    texture: str | None = None
    """Name of a texture, or None for plain colour."""
    specular: float = 0.1
    """Strength of highlights, 0 to 1; skin and cloth are dull."""
    shininess: float = 0.2
    """Narrowness of highlights, 0 to 1."""
    reflectance: float = 0.0
    """0: nothing on an infant mirrors the room."""


@dataclass(frozen=True, slots=True)
class FlatTexture:
    """One `<texture type="2d">` of a skin, whose vertices say where they are in it."""

    name: str
    """Name that a material refers to."""
    file: str
    """Path inside the bundle, a key of `Appearance.assets`."""


@dataclass(frozen=True, slots=True)
class PrintedSkin:
    """One `<skin>`: a mesh that several bodies move, seen but not felt."""

    name: str
    file: str
    """Path inside the bundle, a key of `Appearance.assets`."""
    material: str
    """Name of its material."""


@dataclass(frozen=True, slots=True)
class Appearance:
    """The textures and materials of an infant."""

    textures: tuple[Texture, ...]
    """In the order they are written."""
    materials: tuple[Material, ...]
    """In the order they are written."""
    assets: Mapping[str, bytes]
    """Path inside the bundle to the bytes of a PNG."""
    flat_textures: tuple[FlatTexture, ...] = ()
    """Those of skins, in the order they are written."""
    skins: tuple[PrintedSkin, ...] = ()
    """In the order they are written, and drawn."""
