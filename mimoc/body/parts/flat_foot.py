"""Feet whose toes move together (Mattern et al. 2024): parts at 18 months, and their shapes."""

from mimoc.body.dimensions import Dimensions, Shape
from mimoc.body.part import ALONG_Y, LEG_LENGTH, LEG_SHARE, ReferenceGeom, ReferenceJoint, ReferenceMotor, ReferencePart
from mimoc.body.parts.leg import ANKLE_JOINTS, ANKLE_MOTORS
from mimoc.body.proportions import Proportions
from mimoc.body.sections import CLEARANCE_M
from mimoc.errors import GeometryError
from mimoc.kinds import PartKind

_SOLE_GRIP = (2.0, 0.02, 0.01)

FOOT = (
    ReferencePart(
        "{side}_foot",
        "{side}_lower_leg",
        (
            ReferenceGeom(
                "{side}_foot1", "cylinder", 0.03219, ("foot_breadth", "foot_length"), "heel, as wide as foot_breadth"
            ),
            ReferenceGeom(
                "{side}_foot2",
                "box",
                0.05850,
                ("foot_breadth", "foot_length"),
                "sole, as wide as foot_breadth",
                friction=_SOLE_GRIP,
            ),
            ReferenceGeom(
                "{side}_foot3",
                "cylinder",
                0.01268,
                ("foot_breadth", "foot_length"),
                "ball of the foot, as wide as foot_breadth",
                ALONG_Y,
                _SOLE_GRIP,
            ),
        ),
        ANKLE_JOINTS,
        position_from=LEG_LENGTH,
        rule=LEG_SHARE,
        motors=ANKLE_MOTORS,
        matures_with="ankle",
        skin_spacing_m=0.015,
        torque_site="torque_{side}_ankle",
        runs_along_x=True,
    ),
)

TOES = (
    ReferencePart(
        "{side}_toes",
        "{side}_foot",
        (
            ReferenceGeom(
                "{side}_toes1",
                "box",
                0.01084,
                ("foot_breadth", "foot_length"),
                "toes, as wide as foot_breadth",
                friction=_SOLE_GRIP,
            ),
            ReferenceGeom(
                "{side}_toes2",
                "cylinder",
                0.01226,
                ("foot_breadth", "foot_length"),
                "rounds the toes off at foot_length from the heel",
                ALONG_Y,
                _SOLE_GRIP,
            ),
        ),
        (ReferenceJoint("robot:{side}_toes", (0, -1, 0), (-60, 80), 0.106, 0.04, 0.005, 0.0005),),
        position_from=("foot_length", "foot_breadth"),
        rule="in proportion to the foot",
        motors=(ReferenceMotor("act:{side}_toes", "robot:{side}_toes", 0.33, (-1, 0.3), 1.29, "{side}_foot2"),),
        skin_spacing_m=0.010,
        torque_site="torque_{side}_toes",
        runs_along_x=True,
    ),
)


def flat_foot_dimensions(p: Proportions) -> Dimensions:
    """Return heel, sole and toes, distributed along x so that the foot has its measured length."""
    f = p.foot
    heel_m, toe_m = f.half_breadth_m - CLEARANCE_M, f.half_height_m
    s = (f.length_m - heel_m - toe_m) / 0.084
    if f.length_m <= 2 * f.half_breadth_m:
        raise GeometryError(f"a foot {f.length_m:.3f} m long cannot be {2 * f.half_breadth_m:.3f} m wide")
    half_width_m, half_height_m = f.half_breadth_m, f.half_height_m
    ankle = (0.0, 0.0, 1.5 * half_height_m)
    return Dimensions(
        origins={"{side}_toes": (0.054 * s, 0.0, 0.0)},
        shapes={
            "{side}_foot1": Shape((heel_m, half_height_m - CLEARANCE_M), (-0.016 * s, 0.0, 0.0)),
            "{side}_foot2": Shape((0.035 * s, half_width_m, half_height_m), (0.019 * s, 0.0, 0.0)),
            "{side}_foot3": Shape((half_height_m - CLEARANCE_M, half_width_m - 2 * CLEARANCE_M), (0.054 * s, 0.0, 0.0)),
            "{side}_toes1": Shape(
                (0.007 * s, half_width_m - CLEARANCE_M, half_height_m - CLEARANCE_M), (0.007 * s, 0.0, 0.0)
            ),
            "{side}_toes2": Shape((toe_m, half_width_m), (0.014 * s, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": ankle for k in (1, 2, 3)},
    )


KIND = PartKind("flat_foot", "Feet whose toes move together.", (*FOOT, *TOES), flat_foot_dimensions)
