"""Places on the surface of the body: of the head, whatever its shape, and the regions of the skin."""

import math
from collections.abc import Mapping

from mimoc.anatomy.parts.head import REFERENCE_HEAD_RADIUS_M
from mimoc.base.geometry.primitives import girth
from mimoc.base.geometry.rotations import Vec3
from mimoc.body.tree import BodyTree, Geom
from mimoc.schema.names import SIDES

_REFERENCE_CENTRE_M: Vec3 = (0.01, 0.0, REFERENCE_HEAD_RADIUS_M)  # Of MIMo's head, in its frame.


def head_radius(head: Geom) -> float:
    """Return the radius of a circle with the head's circumference, in [m]."""
    return head.size_m[0] if head.type == "sphere" else girth(head.type, head.size_m) / (2 * math.pi)


def on_head(head: Geom, place: Vec3) -> Vec3:
    """Return a place in the frame of the head's body, in [m], from one in half axes: x forward, y left, z up."""
    x, y, z = (middle + half_m * part for middle, half_m, part in zip(head.pos_m, half_axes(head), place, strict=True))
    return x, y, z


def as_on_mimos_head(head: Geom, pos_m: Vec3) -> Vec3:
    """Return the place that corresponds to one on MIMo's head, a sphere; both in the frame of the head's body."""
    if head.type == "sphere":
        size = head.size_m[0] / REFERENCE_HEAD_RADIUS_M
        return pos_m[0] * size, pos_m[1] * size, pos_m[2] * size
    x, y, z = (
        (part_m - middle_m) / REFERENCE_HEAD_RADIUS_M
        for part_m, middle_m in zip(pos_m, _REFERENCE_CENTRE_M, strict=True)
    )
    return on_head(head, (x, y, z))


def half_axes(head: Geom) -> Vec3:
    """Return the half axes of a head, [m]."""
    radius_m = head.size_m[0]
    return (radius_m, radius_m, radius_m) if head.type == "sphere" else (radius_m, head.size_m[1], head.size_m[2])


BEGINS: Mapping[str, str] = {
    part.format(side=side): region.format(side=side)
    for side in SIDES
    for part, region in (
        ("{side}_upper_arm", "{side}_arm"),
        ("{side}_hand", "{side}_hand"),
        ("{side}_upper_leg", "{side}_leg"),
        ("{side}_foot", "{side}_foot"),
    )
}
"""The region that begins with a body, and ends where another begins."""
PALMS_AND_SOLES = frozenset(region for body, region in BEGINS.items() if body.endswith(("hand", "foot")))
"""Regions that count as smooth skin, without hair."""


def region_of_bodies(body: BodyTree) -> dict[str, str]:
    """Return the region of each body by name; parts that no child has are regions of their own names."""
    regions: dict[str, str] = {}
    for part in body.bodies:
        former = regions.get(part.parent or "", "trunk")
        if part.region != "limb":
            regions[part.name] = part.region
        else:
            regions[part.name] = BEGINS.get(part.name, part.name if former == "trunk" else former)
    return regions
