"""Where the parts of a body are, as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimoc.geometry.rotations import Vec3


@dataclass(frozen=True, slots=True)
class Solid:
    """Size and centre of a geom, as MuJoCo wants them."""

    size_m: tuple[float, ...]
    pos_m: Vec3


@dataclass(frozen=True, slots=True)
class Layout:
    """Where things are on the right side, by their names in `anatomy`."""

    origins: Mapping[str, Vec3] = field(default_factory=dict)
    """Bodies, in the frame of their parent."""
    solids: Mapping[str, Solid] = field(default_factory=dict)
    """Geoms, in the frame of their body."""
    anchors: Mapping[str, Vec3] = field(default_factory=dict)
    """Joints that do not turn about the origin of their body."""

    def __or__(self, other: "Layout") -> "Layout":
        """Return both layouts as one."""
        return Layout(
            {**self.origins, **other.origins},
            {**self.solids, **other.solids},
            {**self.anchors, **other.anchors},
        )
