"""Head and eyes: parts, joints and motors at 18 months, and their shapes by both laws of development."""

import math

from mimoc.anatomy.part import (
    AXIAL_RULE,
    TRUNK_HEIGHT,
    BodyGeometry,
    GeomShape,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
)
from mimoc.anatomy.segments import Proportions
from mimoc.base.geometry.rotations import Vec3

REFERENCE_HEAD_RADIUS_M = 0.0735

HEAD = ReferencePart(
    "head",
    "upper_body",
    (
        ReferenceGeom(
            "head", "sphere", 1.7748, ("head_circumference",), "radius = head_circumference / 2 pi", material="head"
        ),
    ),
    (  # The last four numbers are stiffness [Nm/rad], damping [Nms/rad], friction loss [Nm] and armature [kg m^2].
        ReferenceJoint("robot:head_swivel", (0, 0, 1), (-111, 111), 0.23, 0.29, 0.018, 0.005),
        ReferenceJoint("robot:head_tilt", (0, 1, 0), (-70, 81), 0.45, 0.53, 0.018, 0.005),
        ReferenceJoint("robot:head_tilt_side", (1, 0, 0), (-70, 70), 0.37, 0.29, 0.018, 0.005),
    ),
    position_from=TRUNK_HEIGHT,
    rule=AXIAL_RULE,
    motors=(
        ReferenceMotor("act:head_swivel", "robot:head_swivel", 1.8, (-1, 1), 0.6665, "head"),
        ReferenceMotor("act:head_tilt", "robot:head_tilt", 3.3, (-1, 0.55), 0.9338, "head"),
        ReferenceMotor("act:head_tilt_side", "robot:head_tilt_side", 1.8, (-1, 1), 1.068, "head"),
    ),
    region="head",
    group="neck",
    skin_spacing_m=0.013,
    torque_site="torque_neck",
)

EYE_MOTORS = (
    ReferenceMotor("act:{side}_eye_horizontal", "robot:{side}_eye_horizontal", 0.0054, (-1, 1), 5.11, "{side}_eye1"),
    ReferenceMotor("act:{side}_eye_vertical", "robot:{side}_eye_vertical", 0.0054, (-1, 1), 6.179, "{side}_eye1"),
    ReferenceMotor("act:{side}_eye_torsional", "robot:{side}_eye_torsional", 0.0037, (-1, 1), 25.03, "{side}_eye1"),
)

EYE = ReferencePart(
    "{side}_eye",
    "head",
    (
        ReferenceGeom(
            "{side}_eye1",
            "sphere",
            0.006275,
            ("head_circumference",),
            "in proportion to the head",
            material="eye_{side}",
        ),
    ),
    (  # The last four numbers are in the units of the head's joints.
        ReferenceJoint("robot:{side}_eye_horizontal", (0, 0, -1), (-45, 45), 0.00065, 0.00042, 0.000054, 0.0002),
        ReferenceJoint("robot:{side}_eye_vertical", (0, -1, 0), (-47, 33), 0.00065, 0.00042, 0.000054, 0.0002),
        ReferenceJoint("robot:{side}_eye_torsional", (1, 0, 0), (-8, 8), 0.00267, 0.00042, 0.000037, 0.0002),
    ),
    position_from=("head_circumference",),
    rule="in proportion to the head",
    motors=EYE_MOTORS,
    group="eyes",
    skin_spacing_m=None,
    torque_site="torque_{side}_eye",
)

HEAD_HEIGHT = 1.15
"""Vertical half axis of the head by the radius of a circle with the head's circumference (D): at 18 months,
it is 17 cm from the vertex to the chin (M)."""
HEAD_CENTRE_X = 0.01 / REFERENCE_HEAD_RADIUS_M
"""Distance of the head's centre before the neck joint, in head radii (MIMo)."""
EYE_PLACE: Vec3 = (0.8975, -0.4300, -0.0980)
"""Place of the right eye on the unit sphere that the head is stretched from (D): the eyes are 3.5 cm apart at birth and
4.7 cm at 18 months; MIMo's are 3.6 and 4.9 cm apart, on heads that are 16 % broader."""
EYE_DEPTH = 0.107
"""Depth of the middle of an eyeball below the face, in head radii (D): a little less than MIMo's .114, as the face is
turned further outwards here."""
NECK_RADIUS = 0.028 / REFERENCE_HEAD_RADIUS_M  # Radius of the neck, in head radii (MIMo).
NECK_FROM, NECK_TO = -0.015, 0.030
"""Ends of the neck's axis above the origin of the head, in m at the reference body's spacing of trunk parts (D): its
lower end is in the shoulders, also of tall children with small heads, and its upper end in the head."""


def head_dimensions(p: Proportions) -> BodyGeometry:
    """Return the head by the published law, a ball."""
    radius_m = p.head_radius_m
    s = radius_m / REFERENCE_HEAD_RADIUS_M
    return BodyGeometry(
        origins={"head": (0.0, 0.0, 0.135 * p.trunk.axial)},
        shapes={"head": GeomShape((radius_m,), (0.01 * s, 0.0, radius_m))},
        anchors={"robot:head_tilt": (0.0, 0.0, 0.0123 * s), "robot:head_tilt_side": (0.0, 0.0, 0.0245 * s)},
    )


def eye_dimensions(p: Proportions) -> BodyGeometry:
    """Return the eyes, in proportion to the head, where the published law has them."""
    s = p.head_radius_m / REFERENCE_HEAD_RADIUS_M
    return BodyGeometry(
        origins={"{side}_eye": (0.07 * s, -0.0245 * s, 0.067375 * s)},
        shapes={"{side}_eye1": GeomShape((0.01125 * s,), (0.0, 0.0, 0.0))},
    )


def maturing_head_dimensions(p: Proportions) -> BodyGeometry:
    """Return head, neck and eyes: the crown is where a round head's would be, the chin below the joints of the neck."""
    radius_m = p.head_radius_m
    length_m, breadth_m = p.head_half_axes_m
    half_axes_m = (length_m, breadth_m, HEAD_HEIGHT * radius_m)
    centre_m = (HEAD_CENTRE_X * radius_m, 0.0, 2 * radius_m - half_axes_m[2])
    neck_from_m, neck_to_m = NECK_FROM * p.trunk.axial, NECK_TO * p.trunk.axial
    return BodyGeometry(
        origins={"{side}_eye": _below(half_axes_m, centre_m, EYE_PLACE, EYE_DEPTH * radius_m)},
        shapes={
            "head": GeomShape(half_axes_m, centre_m),
            "neck": GeomShape(
                (NECK_RADIUS * radius_m, (neck_to_m - neck_from_m) / 2), (0.0, 0.0, (neck_from_m + neck_to_m) / 2)
            ),
        },
    )


def _below(half_axes_m: Vec3, centre_m: Vec3, place: Vec3, depth_m: float) -> Vec3:
    """Return the point at a depth below an ellipsoid's surface.

    *place* is the point of the unit sphere that it is stretched from.
    """
    normal = tuple(part / half_m for part, half_m in zip(place, half_axes_m, strict=True))
    length = math.hypot(*normal)
    x, y, z = (
        middle + part * half_m - depth_m * slope / length
        for middle, part, half_m, slope in zip(centre_m, place, half_axes_m, normal, strict=True)
    )
    return x, y, z


KIND = PartKind("head", "Head.", (HEAD,), head_dimensions)
EYES = PartKind("eyes", "Eyes.", (EYE,), eye_dimensions)
