"""A rail to hold on to: a bar across two posts, as high as that of a crib."""

import math
from dataclasses import dataclass

from mimoc.body import BodyTree
from mimoc.body.stature import stature
from mimoc.body.tree import Vec3
from mimoc.mjcf.furniture import RAIL_RADIUS_M, Furniture, WorldGeom, WorldMaterial
from mimoc.units import cm_to_m

HALF_SPAN_IN_CHILDREN = 0.45
"""From the middle of the rail to a post, for one length of the child: as far as an arm reaches to the side."""
POST_RADIUS_M = 0.015
WOOD = WorldMaterial("rail_wood", (0.82, 0.66, 0.46, 1.0))

_ALONG_Y: Vec3 = (math.pi / 2, 0.0, 0.0)
_UPRIGHT: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Rail:
    """A rail along y, on the floor at z = 0."""

    x_m: float
    height_m: float
    """Of its middle."""
    half_span_m: float
    """From its middle to a post."""
    radius_m: float = RAIL_RADIUS_M

    @property
    def furniture(self) -> Furniture:
        """The bar and its posts."""
        bar = WorldGeom(
            "rail",
            "capsule",
            (self.radius_m, self.half_span_m),
            (self.x_m, 0.0, self.height_m),
            _ALONG_Y,
            WOOD.name,
        )
        return Furniture((bar, self._post("left", 1.0), self._post("right", -1.0)), (WOOD,))

    @property
    def feet(self) -> tuple[Vec3, Vec3]:
        """What its posts take up of the floor: discs by x, y and radius, in [m]."""
        return (self.x_m, self.half_span_m, POST_RADIUS_M), (self.x_m, -self.half_span_m, POST_RADIUS_M)

    def _post(self, name: str, side: float) -> WorldGeom:
        place = (self.x_m, side * self.half_span_m, self.height_m / 2)
        return WorldGeom(
            f"rail_post_{name}", "cylinder", (POST_RADIUS_M, self.height_m / 2), place, _UPRIGHT, WOOD.name
        )


def half_span(tree: BodyTree) -> float:
    """Return how far the posts of a rail for this child are from its middle, in [m]."""
    return HALF_SPAN_IN_CHILDREN * cm_to_m(stature(tree)["length_cm"])
