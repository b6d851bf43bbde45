"""Materials and textures of the world in MJCF."""

from dataclasses import dataclass

from mimoc.looks.appearance import Rgba


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
