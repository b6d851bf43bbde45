"""Shapes of head and neck: an ellipsoid, and a capsule inside of it that carries the neck's share of mass."""

import math

from mimoc.body.dimensions import Dimensions, Shape
from mimoc.body.proportions import Proportions
from mimoc.body.segments import REFERENCE_HEAD_RADIUS_M
from mimoc.geometry.rotations import Vec3

HEIGHT = 1.15
"""Vertical half axis by the radius of a circle with the head's circumference (D): at 18 months, it is 17 cm from the
vertex to the chin (M)."""
CENTRE_X = 0.01 / REFERENCE_HEAD_RADIUS_M
"""Of the head before the neck joint, in head radii (MIMo)."""
EYE: Vec3 = (0.8975, -0.4300, -0.0980)
"""Place of the right eye on a sphere, for half axes of one (D): at 18 months, the eyes are 4.6 cm apart; a tenth of the
head's width above MIMo's 4.9 cm on a round head, 14 % broader than this one."""
EYE_DEPTH = 0.107
"""Depth of the middle of an eyeball below the face, in head radii (D): MIMo's .114 less what the face is flatter."""
NECK_RADIUS, TILT_HEIGHT = 0.028 / REFERENCE_HEAD_RADIUS_M, 0.0123 / REFERENCE_HEAD_RADIUS_M
"""Of the neck, and of the joint that the head nods about, in head radii (MIMo)."""


def head_dimensions(p: Proportions) -> Dimensions:
    """Return head, neck and eyes: the crown is where a round head's would be, the chin below the joints of the neck.

    The lower end of the neck is a ball around the joint that the head nods about, so it is in the same place on the
    chest whichever way the head is turned.
    """
    radius_m = p.head_radius_m
    length_m, breadth_m = p.head_half_axes_m
    half_axes_m = (length_m, breadth_m, HEIGHT * radius_m)
    centre_m = (CENTRE_X * radius_m, 0.0, 2 * radius_m - half_axes_m[2])
    neck_half_m = 0.02 * p.trunk.axial
    return Dimensions(
        origins={"{side}_eye": _below(half_axes_m, centre_m, EYE, EYE_DEPTH * radius_m)},
        shapes={
            "head": Shape(half_axes_m, centre_m),
            "neck": Shape((NECK_RADIUS * radius_m, neck_half_m), (0.0, 0.0, TILT_HEIGHT * radius_m + neck_half_m)),
        },
    )


def _below(half_axes_m: Vec3, centre_m: Vec3, place: Vec3, depth_m: float) -> Vec3:
    """Return the point a depth below a place of an ellipsoid's surface, given for half axes of one."""
    normal = tuple(part / half_m for part, half_m in zip(place, half_axes_m, strict=True))
    size = math.hypot(*normal)
    x, y, z = (
        middle + part * half_m - depth_m * across / size
        for middle, part, half_m, across in zip(centre_m, place, half_axes_m, normal, strict=True)
    )
    return x, y, z
