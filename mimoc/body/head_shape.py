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
"""Place of the right eye, for half axes of one (D): the eyes are 3.5 cm apart at birth and 4.7 cm at 18 months; MIMo's
are 3.6 and 4.9 cm apart, on heads that are 16 % broader."""
EYE_DEPTH = 0.107
"""Depth of the middle of an eyeball below the face, in head radii (D): a little less than MIMo's .114, as the face is
turned further outwards here."""
NECK_RADIUS = 0.028 / REFERENCE_HEAD_RADIUS_M
"""In head radii (MIMo)."""
NECK_FROM, NECK_TO = -0.015, 0.030
"""Ends of the neck's axis above the origin of the head, in m at the reference body's spacing of trunk parts (D): its
lower end is in the shoulders, also of tall children with small heads, and its upper end in the head."""


def head_dimensions(p: Proportions) -> Dimensions:
    """Return head, neck and eyes: the crown is where a round head's would be, the chin below the joints of the neck."""
    radius_m = p.head_radius_m
    length_m, breadth_m = p.head_half_axes_m
    half_axes_m = (length_m, breadth_m, HEIGHT * radius_m)
    centre_m = (CENTRE_X * radius_m, 0.0, 2 * radius_m - half_axes_m[2])
    neck_from_m, neck_to_m = NECK_FROM * p.trunk.axial, NECK_TO * p.trunk.axial
    return Dimensions(
        origins={"{side}_eye": _below(half_axes_m, centre_m, EYE, EYE_DEPTH * radius_m)},
        shapes={
            "head": Shape(half_axes_m, centre_m),
            "neck": Shape(
                (NECK_RADIUS * radius_m, (neck_to_m - neck_from_m) / 2), (0.0, 0.0, (neck_from_m + neck_to_m) / 2)
            ),
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
