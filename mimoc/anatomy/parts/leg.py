"""Thigh and shank: parts, joints and motors at 18 months, and their shapes."""

from mimoc.anatomy.dimensions import BodyGeometry, GeomShape, along
from mimoc.anatomy.part import (
    LEG_LENGTH,
    LEG_SHARE,
    THIGH_LENGTH,
    TRUNK_HEIGHT,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
)
from mimoc.anatomy.parts.trunk import PELVIS_X_M, PELVIS_Z_M, REFERENCE_PELVIS_RADIUS_M
from mimoc.anatomy.segments import Proportions
from mimoc.base.errors import GeometryError

LEG = (
    ReferencePart(
        "{side}_upper_leg",
        "hip",
        (
            ReferenceGeom(
                "{side}_upper_leg1",
                "capsule",
                0.7998,
                THIGH_LENGTH,
                "radius = mid_thigh_circumference / 2 pi, from the hip to one calf radius past the knee",
                contype=2,
                conaffinity=3,
                material="pants_leg",
            ),
        ),
        (
            ReferenceJoint("robot:{side}_hip1", (0, 1, 0), (-133, 20), 1.72, 1.27, 0.08, 0.005, -10),
            ReferenceJoint("robot:{side}_hip2", (1, 0, 0), (-51, 17), 3.51, 1.99, 0.062, 0.005),
            ReferenceJoint("robot:{side}_hip3", (0, 0, -1), (-32, 41), 2.16, 0.75, 0.027, 0.005),
        ),
        position_from=TRUNK_HEIGHT,
        rule=".26 of hip_breadth to the side; behind and below the pelvis's middle, in proportion to its radius",
        motors=(
            ReferenceMotor("act:{side}_hip_flex", "robot:{side}_hip1", 8, (-1, 1), 1.083, "{side}_upper_leg1"),
            ReferenceMotor("act:{side}_hip_abduction", "robot:{side}_hip2", 6.24, (-1, 1), 1.488, "{side}_upper_leg1"),
            ReferenceMotor("act:{side}_hip_rotation", "robot:{side}_hip3", 3.54, (-0.75, 1), 1.86, "{side}_upper_leg1"),
        ),
        group="{side}_leg",
        matures_with="hip",
        skin_spacing_m=0.027,
        torque_site="torque_{side}_hip",
    ),
    ReferencePart(
        "{side}_lower_leg",
        "{side}_upper_leg",
        (
            ReferenceGeom(
                "{side}_lower_leg1",
                "capsule",
                0.3341,
                LEG_LENGTH,
                "radius = calf_circumference / 2 pi, upper half of the shank",
            ),
            ReferenceGeom(
                "{side}_lower_leg2",
                "capsule",
                0.1160,
                ("ankle_circumference", *LEG_LENGTH),
                "radius = ankle_circumference / 2 pi, lower half of the shank, into the foot",
            ),
        ),
        (ReferenceJoint("robot:{side}_knee", (0, -1, 0), (-145, 4), 1.63, 0.53, 0.065, 0.003, -30),),
        position_from=THIGH_LENGTH,
        rule=LEG_SHARE,
        motors=(ReferenceMotor("act:{side}_knee", "robot:{side}_knee", 10, (-0.65, 1), 1.45, "{side}_lower_leg1"),),
        matures_with="knee",
        skin_spacing_m=0.038,
        torque_site="torque_{side}_knee",
    ),
)

ANKLE_JOINTS = (
    ReferenceJoint("robot:{side}_foot1", (0, -1, 0), (-63, 32), 1.29, 0.6, 0.019, 0.003, -10),
    ReferenceJoint("robot:{side}_foot2", (1, 0, 0), (-33, 31), 0.96, 0.37, 0.011, 0.0025),
    ReferenceJoint("robot:{side}_foot3", (0, 0, 1), (-20, 30), 1.15, 0.38, 0.012, 0.002),
)
"""The joints between a shank and any foot (MIMo)."""
ANKLE_MOTORS = (
    ReferenceMotor("act:{side}_foot_flexion", "robot:{side}_foot1", 3.78, (-1, 0.5), 1.43, "{side}_foot2"),
    ReferenceMotor("act:{side}_foot_inversion", "robot:{side}_foot2", 1.16, (-0.91, 1), 1.988, "{side}_foot2"),
    ReferenceMotor("act:{side}_foot_rotation", "robot:{side}_foot3", 1.2, (-1, 1), 2.688, "{side}_foot2"),
)


def leg_dimensions(p: Proportions) -> BodyGeometry:
    """Return thigh and shank."""
    thigh, shank = p.thigh, p.shank
    into_foot_m = shank.length_m + 0.6 * p.foot.half_height_m
    lower_start_m, lower_end_m = 0.6 * shank.length_m, into_foot_m - p.ankle_radius_m
    if lower_end_m <= lower_start_m:
        raise GeometryError(
            f"a shank {shank.length_m:.3f} m long cannot have an ankle {2 * p.ankle_radius_m:.3f} m thick"
        )
    # The hip joint is behind and below the middle of the pelvis.
    radius_m = p.trunk.pelvis[0]
    x_m = PELVIS_X_M * radius_m / REFERENCE_PELVIS_RADIUS_M - (radius_m - p.trunk.buttocks_m)
    return BodyGeometry(
        origins={
            "{side}_upper_leg": (x_m, -p.trunk.hip_y_m, PELVIS_Z_M * p.trunk.axial - (radius_m - p.trunk.rump_m)),
            "{side}_lower_leg": (p.knee_forward_m, 0.0, -thigh.length_m),
            "{side}_foot": (0.0, 0.0, -shank.length_m),
        },
        shapes={
            "{side}_upper_leg1": along("thigh", thigh.length_m, thigh.radius_m, shank.radius_m, down=True),
            "{side}_lower_leg1": GeomShape(
                (shank.radius_m, 0.044 / 0.177 * shank.length_m), (0.0, 0.0, -0.044 / 0.177 * shank.length_m)
            ),
            "{side}_lower_leg2": GeomShape(
                (p.ankle_radius_m, (lower_end_m - lower_start_m) / 2), (0.0, 0.0, -(lower_start_m + lower_end_m) / 2)
            ),
        },
    )


KIND = PartKind("leg", "Thighs and shanks.", LEG, leg_dimensions)
