"""Arms, legs and feet, but no hands: parts, joints and motors at 18 months, and their shapes.

The toes of feet move together (Mattern et al. 2024) or, in MIMo's second body, with a separate big toe. Names with
`{side}` stand for a right and a left part; values are those of the right side.
"""

from dataclasses import replace

from mimoc.anatomy.part import (
    ALONG_Y,
    LEG_LENGTH,
    LEG_SHARE,
    REST_ABDUCTION_DEG,
    SHOULDERS,
    THIGH_LENGTH,
    TRUNK_HEIGHT,
    BodyGeometry,
    GeomShape,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
    along,
)
from mimoc.anatomy.parts.trunk import PELVIS_X_M, PELVIS_Z_M, REFERENCE_PELVIS_RADIUS_M, behind_chest
from mimoc.anatomy.sections import CLEARANCE_M, SHOULDER_BACK
from mimoc.anatomy.segments import REFERENCE_M, Foot, Proportions
from mimoc.base.errors import GeometryError

UPPER_ARM_MOTORS = (
    ReferenceMotor(
        "act:{side}_shoulder_horizontal", "robot:{side}_shoulder_horizontal", 1.8, (-1, 1), 1.811, "{side}_uarm1"
    ),
    ReferenceMotor(
        "act:{side}_shoulder_abduction", "robot:{side}_shoulder_ad_ab", 4, (-0.6875, 1), 0.8793, "{side}_uarm1"
    ),
    ReferenceMotor(
        "act:{side}_shoulder_internal", "robot:{side}_shoulder_rotation", 2.5, (-1, 0.64), 1.498, "{side}_uarm1"
    ),
)

ARM_PARTS = (
    ReferencePart(
        "{side}_upper_arm",
        "chest",
        (
            ReferenceGeom(
                "{side}_uarm1",
                "capsule",
                0.2684,
                ("upper_arm_circumference", "shoulder_elbow_length"),
                "radius = upper_arm_circumference / 2 pi, from the shoulder to one forearm radius past the elbow; "
                "nearer to the midline than its joint, so shoulder_breadth is over the arms unless ribs stop it",
                position_from=SHOULDERS,
                material="top_sleeve",
            ),
        ),
        (
            ReferenceJoint("robot:{side}_shoulder_horizontal", (0, 1, -4), (-28, 118), 0.09, 0.05, 0.0009, 0.004),
            ReferenceJoint("robot:{side}_shoulder_ad_ab", (-1, 0, 0), (-84, 183), 0.11, 0.10, 0.0014, 0.004),
            ReferenceJoint("robot:{side}_shoulder_rotation", (0, 0, -1), (-99, 67), 0.12, 0.07, 0.0008, 0.004),
        ),
        euler_deg=(180.0 - REST_ABDUCTION_DEG, 0.0, 0.0),
        position_from=SHOULDERS,
        rule=".433 of shoulder_breadth to the side (MIMo's spacing), half of the chest's radius behind its middle; "
        "further out where scaled parts would overlap by more than half of the arm's radius",
        keeps_clear_of="upper_body",
        motors=UPPER_ARM_MOTORS,
        group="{side}_arm",
        skin_spacing_m=0.024,
        torque_site="torque_{side}_shoulder",
    ),
    ReferencePart(
        "{side}_lower_arm",
        "{side}_upper_arm",
        (
            ReferenceGeom(
                "{side}_larm",
                "capsule",
                0.1853,
                (
                    "forearm_circumference",
                    "elbow_hand_length",
                    "hand_length",
                    "hand_breadth",
                    "upper_arm_circumference",
                ),
                "radius = forearm_circumference / 2 pi, from the elbow to half a hand's thickness past the wrist",
            ),
        ),
        (ReferenceJoint("robot:{side}_elbow", (0, -1, 0), (-146, 5), 0.13, 0.11, 0.030, 0.002, -20),),
        position_from=("shoulder_elbow_length", "upper_arm_circumference", "forearm_circumference"),
        rule="shoulder_elbow_length less the radii of upper arm and forearm, which are above and below the joints",
        motors=(ReferenceMotor("act:{side}_elbow", "robot:{side}_elbow", 3.6, (-1, 0.83), 1.566, "{side}_larm"),),
        skin_spacing_m=0.024,
        torque_site="torque_{side}_elbow",
    ),
)

WRIST_JOINTS = (
    ReferenceJoint("robot:{side}_hand1", (0, 0, -1), (-90, 90), 0.22, 0.03, 0.007, 0.001, -20),
    ReferenceJoint("robot:{side}_hand2", (-1, 0, 0), (-92, 86), 0.33, 0.11, 0.007, 0.001),
    ReferenceJoint("robot:{side}_hand3", (0, 1, 0), (-53, 48), 0.38, 0.11, 0.007, 0.001),
)
"""The joints between a forearm and any hand (MIMo)."""
WRIST_MOTORS = (
    ReferenceMotor("act:{side}_wrist_rotation", "robot:{side}_hand1", 0.7, (-1, 1), 1.513, "{side}_hand1"),
    ReferenceMotor("act:{side}_wrist_flexion", "robot:{side}_hand2", 1.24, (-1, 0.57), 1.455, "{side}_hand1"),
    ReferenceMotor("act:{side}_wrist_ulnar", "robot:{side}_hand3", 0.95, (-0.87, 1), 2.254, "{side}_hand1"),
)


def arm_dimensions(p: Proportions) -> BodyGeometry:
    """Return upper arm and forearm."""
    upper, y_m = p.upper_arm, -p.trunk.arm_inwards_m  # The arm hangs: its y points to the midline.
    return BodyGeometry(
        origins={
            "{side}_upper_arm": (behind_chest(p.trunk, SHOULDER_BACK), -p.trunk.shoulder_y_m, 0.003 * p.trunk.axial),
            "{side}_lower_arm": (0.0, 0.0, p.upper_arm.length_m),
        },
        shapes={
            "{side}_uarm1": along("upper arm", upper.length_m, upper.radius_m, p.forearm.radius_m, y_m),
            "{side}_larm": along("forearm", p.forearm.length_m, p.forearm.radius_m, p.hand.half_thickness_m),
        },
        anchors={"robot:{side}_shoulder_horizontal": (0.0, -p.upper_arm.radius_m, 0.0)},
    )


ARM = PartKind("arm", "Upper arms and forearms.", ARM_PARTS, arm_dimensions)


LEG_PARTS = (
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
    lower_start_m = 0.6 * shank.length_m
    lower_end_m = into_foot_m - p.ankle_radius_m
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


LEG = PartKind("leg", "Thighs and shanks.", LEG_PARTS, leg_dimensions)


_SOLE_GRIP = (2.0, 0.02, 0.01)
_SIZE = ("foot_breadth", "foot_length")
_WIDE = "as wide as foot_breadth"
_TIP_RULE = "rounds the toes off at foot_length from the heel"


def _foot(masses_kg: tuple[float, float, float], size_from: tuple[str, ...]) -> ReferencePart:
    """Return a foot without its toes: heel, sole and ball."""
    heel, sole, ball = (f"{{side}}_foot{number}" for number in (1, 2, 3))
    heel_kg, sole_kg, ball_kg = masses_kg
    return ReferencePart(
        "{side}_foot",
        "{side}_lower_leg",
        (
            ReferenceGeom(heel, "cylinder", heel_kg, size_from, f"heel, {_WIDE}"),
            ReferenceGeom(sole, "box", sole_kg, size_from, f"sole, {_WIDE}", friction=_SOLE_GRIP),
            ReferenceGeom(ball, "cylinder", ball_kg, size_from, f"ball of the foot, {_WIDE}", ALONG_Y, _SOLE_GRIP),
        ),
        ANKLE_JOINTS,
        position_from=LEG_LENGTH,
        rule=LEG_SHARE,
        motors=ANKLE_MOTORS,
        matures_with="ankle",
        skin_spacing_m=0.015,
        torque_site="torque_{side}_ankle",
        runs_along_x=True,
    )


TOES = ReferencePart(
    "{side}_toes",
    "{side}_foot",
    (
        ReferenceGeom("{side}_toes1", "box", 0.01084, _SIZE, f"toes, {_WIDE}", friction=_SOLE_GRIP),
        ReferenceGeom("{side}_toes2", "cylinder", 0.01226, _SIZE, _TIP_RULE, ALONG_Y, _SOLE_GRIP),
    ),
    (ReferenceJoint("robot:{side}_toes", (0, -1, 0), (-60, 80), 0.106, 0.04, 0.005, 0.0005),),
    position_from=_SIZE[::-1],
    rule="in proportion to the foot",
    motors=(ReferenceMotor("act:{side}_toes", "robot:{side}_toes", 0.33, (-1, 0.3), 1.29, "{side}_foot2"),),
    skin_spacing_m=0.010,
    torque_site="torque_{side}_toes",
    runs_along_x=True,
)


def _half_of_toes(name: str, masses_kg: tuple[float, float], vmax_lengths_per_s: float) -> ReferencePart:
    """Return the big toe or the others, half as stiff and strong as all of them."""
    box = f"{{side}}_{name}1"
    tip = f"{{side}}_{name}2"
    joint = f"robot:{{side}}_{name}"
    motor = ReferenceMotor(f"act:{{side}}_{name}", joint, 0.165, (-1.0, 0.3), vmax_lengths_per_s, box)
    return replace(
        TOES,
        name=f"{{side}}_{name}",
        geoms=(
            ReferenceGeom(box, "box", masses_kg[0], _SIZE[::-1], "a share of foot_breadth wide", friction=_SOLE_GRIP),
            ReferenceGeom(tip, "cylinder", masses_kg[1], _SIZE[::-1], _TIP_RULE, ALONG_Y, _SOLE_GRIP),
        ),
        joints=(ReferenceJoint(joint, (0, -1, 0), (-60, 80), 0.053, 0.02, 0.002, 0.0001),),
        rule="at the ball of the foot",
        motors=(motor,),
        torque_site=f"torque_{{side}}_{name}",
    )


def flat_foot_dimensions(p: Proportions) -> BodyGeometry:
    """Return heel, sole and toes, distributed along x so that the foot has its measured length."""
    f = p.foot
    s = _stretch(f, 0.084)
    sole = _foot_dimensions(f, -0.016 * s, (0.035 * s, 0.019 * s), 0.054 * s)
    toes = _toes_dimensions("toes", 0.007 * s, f.half_breadth_m, f.half_height_m)
    return sole | toes | BodyGeometry(origins={"{side}_toes": (0.054 * s, 0.0, 0.0)})


def two_toed_foot_dimensions(p: Proportions) -> BodyGeometry:
    """Return heel, sole, big toe and toes, distributed along x so that the foot has its measured length."""
    f = p.foot
    s = _stretch(f, 0.079)
    wide = f.half_breadth_m / (REFERENCE_M["foot_breadth"] / 2)
    return (
        _foot_dimensions(f, -0.007 * s, (0.030 * s, 0.023 * s), 0.053 * s)
        | _toes_dimensions("big_toe", 0.0095 * s, 0.0075 * wide, f.half_height_m)
        | _toes_dimensions("toes", 0.0095 * s, 0.0165 * wide, f.half_height_m)
        | BodyGeometry(
            {"{side}_big_toe": (0.053 * s, 0.0175 * wide, 0.0), "{side}_toes": (0.053 * s, -0.0075 * wide, 0.0)}
        )
    )


def _stretch(f: Foot, between_m: float) -> float:
    """Return by how much a foot, which may not be wider than long, is longer between its rounded ends than MIMo's."""
    if f.length_m <= 2 * f.half_breadth_m:
        raise GeometryError(f"a foot {f.length_m:.3f} m long cannot be {2 * f.half_breadth_m:.3f} m wide")
    heel_m = f.half_breadth_m - CLEARANCE_M
    return (f.length_m - heel_m - f.half_height_m) / between_m


def _foot_dimensions(f: Foot, heel_x_m: float, sole_m: tuple[float, float], ball_x_m: float) -> BodyGeometry:
    """Return heel, sole and ball from their places along x; *sole_m* is half its length, and its middle."""
    width_m, height_m, (half_m, sole_x_m) = f.half_breadth_m, f.half_height_m, sole_m
    return BodyGeometry(
        shapes={
            "{side}_foot1": GeomShape((width_m - CLEARANCE_M, height_m - CLEARANCE_M), (heel_x_m, 0.0, 0.0)),
            "{side}_foot2": GeomShape((half_m, width_m, height_m), (sole_x_m, 0.0, 0.0)),
            "{side}_foot3": GeomShape((height_m - CLEARANCE_M, width_m - 2 * CLEARANCE_M), (ball_x_m, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": (0.0, 0.0, 1.5 * height_m) for k in (1, 2, 3)},
    )


def _toes_dimensions(name: str, half_m: float, half_width_m: float, height_m: float) -> BodyGeometry:
    box_m = (half_m, half_width_m - CLEARANCE_M, height_m - CLEARANCE_M)
    return BodyGeometry(
        shapes={
            f"{{side}}_{name}1": GeomShape(box_m, (half_m, 0.0, 0.0)),
            f"{{side}}_{name}2": GeomShape((height_m, half_width_m), (2 * half_m, 0.0, 0.0)),
        }
    )


FLAT = PartKind(
    "flat_foot", "Toes move together.", (_foot((0.03219, 0.0585, 0.01268), _SIZE), TOES), flat_foot_dimensions
)
_TWO_TOED = _foot((0.03225, 0.04923, 0.01312), _SIZE[::-1])
_BIG_TOE = _half_of_toes("big_toe", (0.004425, 0.003934), 1.774)
_OTHER_TOES = _half_of_toes("toes", (0.01006, 0.008612), 1.805)
RIGHT_TWO_TOED = PartKind(
    "two_toed_foot", "The big toe moves by itself.", (_TWO_TOED, _BIG_TOE, _OTHER_TOES), two_toed_foot_dimensions
)
LEFT_TWO_TOED = replace(RIGHT_TWO_TOED, parts=(_TWO_TOED, _OTHER_TOES, _BIG_TOE))
"""MIMo lists the left toes in reverse order."""
