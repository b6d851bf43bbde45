"""Sizes and positions of the parts of a body, as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimoc.geometry.rotations import Vec3


@dataclass(frozen=True, slots=True)
class Shape:
    """Size and centre of a geom, as MuJoCo wants them."""

    size_m: tuple[float, ...]
    pos_m: Vec3


@dataclass(frozen=True, slots=True)
class Dimensions:
    """Sizes and positions on the right side, by the names in `anatomy`."""

    origins: Mapping[str, Vec3] = field(default_factory=dict)
    """Bodies, in the frame of their parent."""
    shapes: Mapping[str, Shape] = field(default_factory=dict)
    """Geoms, in the frame of their body."""
    anchors: Mapping[str, Vec3] = field(default_factory=dict)
    """Joints that do not turn about the origin of their body."""

    def __or__(self, other: "Dimensions") -> "Dimensions":
        """Return the union of both."""
        return Dimensions(
            {**self.origins, **other.origins},
            {**self.shapes, **other.shapes},
            {**self.anchors, **other.anchors},
        )
