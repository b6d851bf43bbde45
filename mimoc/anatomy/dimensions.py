"""Sizes and positions of the parts of a body, as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimoc.base.errors import GeometryError
from mimoc.base.geometry.rotations import Vec3


@dataclass(frozen=True, slots=True)
class GeomShape:
    """Size and centre of a geom, as in MuJoCo."""

    size_m: tuple[float, ...]
    pos_m: Vec3


@dataclass(frozen=True, slots=True)
class BodyGeometry:
    """Sizes and positions of the right side, by the names in `anatomy`."""

    origins: Mapping[str, Vec3] = field(default_factory=dict)
    """Origins of bodies, in the frame of their parent."""
    shapes: Mapping[str, GeomShape] = field(default_factory=dict)
    """Shapes of geoms, in the frame of their body."""
    anchors: Mapping[str, Vec3] = field(default_factory=dict)
    """Anchors of the joints that are not at the origin of their body."""

    def __or__(self, other: "BodyGeometry") -> "BodyGeometry":
        return BodyGeometry(
            {**self.origins, **other.origins}, {**self.shapes, **other.shapes}, {**self.anchors, **other.anchors}
        )


def mirror(vector: Vec3, left: bool) -> Vec3:
    """Return a position, mirrored in y for the left side."""
    x, y, z = vector
    return (x, -y, z) if left else vector


def mirror_turn(vector: Vec3, left: bool) -> Vec3:
    """Return an axis or Euler angles, mirrored in y: rotations about x and z change sign, about y they do not."""
    x, y, z = vector
    return (-x, y, -z) if left else vector


def along(
    what: str, length_m: float, radius_m: float, embed_m: float, y_m: float = 0.0, down: bool = False
) -> GeomShape:
    """Return a capsule on z from a joint to *embed_m* beyond the next; GeometryError if it is wider than long."""
    axis_m = length_m + embed_m - radius_m
    if axis_m <= 0:
        raise GeometryError(f"{what}: a limb {length_m:.3f} m long cannot be {2 * radius_m:.3f} m thick")
    return GeomShape((radius_m, axis_m / 2), (0.0, y_m, -axis_m / 2 if down else axis_m / 2))
