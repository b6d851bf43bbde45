"""Lights in MJCF."""

from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3


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
    attenuation: Vec3
    """Constant, linear and quadratic."""
    cutoff_deg: float
    """In degrees even where the compiler's angles are radians."""
    exponent: float
    castshadow: bool


@dataclass(frozen=True, slots=True)
class Headlight:
    """MuJoCo's light at the camera, under `<visual>`."""

    ambient: Vec3
    """From all directions."""
    diffuse: Vec3
    """From the camera: little, or walls get brighter when a head turns to them."""


OUTDOORS = Headlight((0.43, 0.43, 0.43), (0.24, 0.24, 0.24))
"""Beside the sun; all three together just do not overexpose skin."""
