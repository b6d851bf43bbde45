"""Sizes and positions of the parts of a body, as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimoc.geometry.rotations import Vec3


@dataclass(frozen=True, slots=True)
class Shape:
    """Size and centre of a geom, as in MuJoCo."""

    size_m: tuple[float, ...]
    pos_m: Vec3


@dataclass(frozen=True, slots=True)
class Dimensions:
    """Sizes and positions of the right side, by the names in `anatomy`."""

    origins: Mapping[str, Vec3] = field(default_factory=dict)
    """Origins of bodies, in the frame of their parent."""
    shapes: Mapping[str, Shape] = field(default_factory=dict)
    """Shapes of geoms, in the frame of their body."""
    anchors: Mapping[str, Vec3] = field(default_factory=dict)
    """Anchors of the joints that are not at the origin of their body."""

    def __or__(self, other: "Dimensions") -> "Dimensions":
        """Return the union of both."""
        return Dimensions(
            {**self.origins, **other.origins},
            {**self.shapes, **other.shapes},
            {**self.anchors, **other.anchors},
        )


def mirror(vector: Vec3, left: bool) -> Vec3:
    """Return a position, mirrored in y for the left side."""
    x, y, z = vector
    return (x, -y, z) if left else vector


def mirror_turn(vector: Vec3, left: bool) -> Vec3:
    """Return an axis or Euler angles, mirrored in y: rotations about x and z change sign, about y they do not."""
    x, y, z = vector
    return (-x, y, -z) if left else vector
