"""Places on the head's surface, whatever its shape."""

import math

from mimoc.anatomy.parts.head import REFERENCE_HEAD_RADIUS_M
from mimoc.base.geometry.primitives import girth
from mimoc.base.geometry.rotations import Vec3
from mimoc.body.tree import Geom

_REFERENCE_CENTRE_M: Vec3 = (0.01, 0.0, REFERENCE_HEAD_RADIUS_M)
"""Of MIMo's head, in its frame."""


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
