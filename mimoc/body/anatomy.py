"""The reference body without hands and feet: its parts, joints and motors, and MIMo's values for them at 18 months.

Names with `{side}` stand for a right and a left part; values are those of the right side (the left is its mirror
image in y). Sizes and positions follow from measurements (`segments`, `extremities`).
Source: MIMo v2's published models (Mattern et al. 2024; López et al. 2025).
"""

from mimoc.body import motors
from mimoc.body.figures import (
    ALONG_Y,
    LEG_LENGTH,
    LEG_SHARE,
    REST_ABDUCTION_DEG,
    THIGH_LENGTH,
    TRUNK_HEIGHT,
    GeomFigures,
    JointFigures,
    Part,
)

REFERENCE_AGE_MONTHS = 18.0
"""Age at which actuator gears are those of MIMo."""

SHOULDERS = ("shoulder_breadth", "upper_arm_circumference", "chest_circumference", "chest_breadth", *TRUNK_HEIGHT)
"""What places the shoulders: arms may be nearer to the midline the higher above the chest they are."""

_AXIAL = "trunk height (crown_rump_length less head and pelvis) in the reference body's proportions"

TRUNK = (
    Part(
        "hip",
        None,
        (
            GeomFigures(
                "lb",
                "capsule",
                1.1584,
                ("hip_breadth", "hip_circumference"),
                "level section with girth hip_circumference and breadth hip_breadth, both evened by up to 2 %",
                ALONG_Y,
                placed_by=TRUNK_HEIGHT,
                material="pants_down",
            ),
        ),
        region="trunk",
        group="trunk",
        skin_spacing_m=0.025,
    ),
    Part(
        "lower_body",
        "hip",
        (
            GeomFigures(
                "cb",
                "capsule",
                1.3245,
                ("hip_breadth", "waist_circumference"),
                "level section with the girth waist_circumference and .93 of hip_breadth, both evened by up to 3 %",
                ALONG_Y,
                placed_by=TRUNK_HEIGHT,
                contype=0,
                conaffinity=1,
                material="pants_up",
            ),
        ),
        (
            JointFigures("robot:hip_lean1", (1, 0, 0), (-14, 14), 3.38, 0.77, 0.049, 0.01),
            JointFigures("robot:hip_rot1", (0, 0, 1), (-18, 18), 1.45, 0.29, 0.018, 0.01),
            JointFigures("robot:hip_bend1", (0, 1, 0), (-17, 30.5), 2.20, 0.84, 0.040, 0.01),
        ),
        follows=TRUNK_HEIGHT,
        rule=_AXIAL,
        motors=motors.LOWER_BODY_MOTORS,
        region="trunk",
        skin_spacing_m=0.025,
        torque_site="torque_lb",
    ),
    Part(
        "upper_body",
        "lower_body",
        (
            GeomFigures(
                "ub1",
                "capsule",
                1.0882,
                ("chest_breadth", "chest_circumference", *TRUNK_HEIGHT),
                "level section like the chest's, no deeper than there is room above the pelvis",
                ALONG_Y,
                material="top_down",
            ),
            GeomFigures(
                "ub2",
                "capsule",
                0.9499,
                ("chest_breadth", "chest_circumference"),
                "level section with girth chest_circumference and breadth chest_breadth, both evened by up to 2 %",
                ALONG_Y,
                placed_by=TRUNK_HEIGHT,
                material="top_middle",
            ),
            GeomFigures(
                "neck",
                "capsule",
                0.0,
                TRUNK_HEIGHT,
                "massless filler between chest and head, in proportion to the head",
                contype=0,
                conaffinity=0,
            ),
        ),
        (
            JointFigures("robot:hip_lean2", (1, 0, 0), (-27, 27), 1.69, 0.38, 0.024, 0.01),
            JointFigures("robot:hip_rot2", (0, 0, 1), (-18, 18), 1.45, 0.29, 0.018, 0.01),
            JointFigures("robot:hip_bend2", (0, 1, 0), (-17, 30.5), 2.20, 0.84, 0.040, 0.01),
        ),
        follows=TRUNK_HEIGHT,
        rule=_AXIAL,
        region="trunk",
        skin_spacing_m=0.030,
        torque_site="torque_ub",
    ),
    Part(
        "chest",
        "upper_body",
        (
            GeomFigures(
                "ub3",
                "capsule",
                0.7217,
                SHOULDERS,
                "between the upper arms, .62 of the chest's radius",
                ALONG_Y,
                material="top_up",
            ),
        ),
        follows=TRUNK_HEIGHT,
        rule=_AXIAL,
        region="trunk",
        skin_spacing_m=0.030,
        torque_site="torque_chest",
    ),
)

ARM = (
    Part(
        "{side}_upper_arm",
        "chest",
        (
            GeomFigures(
                "{side}_uarm1",
                "capsule",
                0.2684,
                ("upper_arm_circumference", "shoulder_elbow_length"),
                "radius = upper_arm_circumference / 2 pi, from the shoulder to one forearm radius past the elbow; "
                "nearer to the midline than its joint, so shoulder_breadth is over the arms unless ribs stop it",
                placed_by=SHOULDERS,
                material="top_sleeve",
            ),
        ),
        (
            JointFigures("robot:{side}_shoulder_horizontal", (0, 1, -4), (-28, 118), 0.09, 0.05, 0.0009, 0.004),
            JointFigures("robot:{side}_shoulder_ad_ab", (-1, 0, 0), (-84, 183), 0.11, 0.10, 0.0014, 0.004),
            JointFigures("robot:{side}_shoulder_rotation", (0, 0, -1), (-99, 67), 0.12, 0.07, 0.0008, 0.004),
        ),
        euler_deg=(180.0 - REST_ABDUCTION_DEG, 0.0, 0.0),
        follows=SHOULDERS,
        rule=".433 of shoulder_breadth to the side (MIMo's spacing), half of the chest's radius behind its middle; "
        "further out where scaled parts would overlap by more than half of the arm's radius",
        keeps_clear_of="upper_body",
        motors=motors.UPPER_ARM_MOTORS,
        group="{side}_arm",
        skin_spacing_m=0.024,
        torque_site="torque_{side}_shoulder",
    ),
    Part(
        "{side}_lower_arm",
        "{side}_upper_arm",
        (
            GeomFigures(
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
        (JointFigures("robot:{side}_elbow", (0, -1, 0), (-146, 5), 0.13, 0.11, 0.030, 0.002, -20),),
        follows=("shoulder_elbow_length", "upper_arm_circumference", "forearm_circumference"),
        rule="shoulder_elbow_length less the radii of upper arm and forearm, which are above and below the joints",
        motors=motors.LOWER_ARM_MOTORS,
        skin_spacing_m=0.024,
        torque_site="torque_{side}_elbow",
    ),
)

HEAD = (
    Part(
        "head",
        "upper_body",
        (
            GeomFigures(
                "head", "sphere", 1.7748, ("head_circumference",), "radius = head_circumference / 2 pi", material="head"
            ),
        ),
        (
            JointFigures("robot:head_swivel", (0, 0, 1), (-111, 111), 0.23, 0.29, 0.018, 0.005),
            JointFigures("robot:head_tilt", (0, 1, 0), (-70, 81), 0.45, 0.53, 0.018, 0.005),
            JointFigures("robot:head_tilt_side", (1, 0, 0), (-70, 70), 0.37, 0.29, 0.018, 0.005),
        ),
        follows=TRUNK_HEIGHT,
        rule=_AXIAL,
        motors=motors.HEAD_MOTORS,
        region="head",
        group="neck",
        skin_spacing_m=0.013,
        torque_site="torque_neck",
    ),
)

EYE = (
    Part(
        "{side}_eye",
        "head",
        (
            GeomFigures(
                "{side}_eye1",
                "sphere",
                0.006275,
                ("head_circumference",),
                "in proportion to the head",
                material="eye_{side}",
            ),
        ),
        (
            JointFigures("robot:{side}_eye_horizontal", (0, 0, -1), (-45, 45), 0.00065, 0.00042, 0.000054, 0.0002),
            JointFigures("robot:{side}_eye_vertical", (0, -1, 0), (-47, 33), 0.00065, 0.00042, 0.000054, 0.0002),
            JointFigures("robot:{side}_eye_torsional", (1, 0, 0), (-8, 8), 0.00267, 0.00042, 0.000037, 0.0002),
        ),
        follows=("head_circumference",),
        rule="in proportion to the head",
        motors=motors.EYE_MOTORS,
        group="eyes",
        skin_spacing_m=None,
        torque_site="torque_{side}_eye",
    ),
)

LEG = (
    Part(
        "{side}_upper_leg",
        "hip",
        (
            GeomFigures(
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
            JointFigures("robot:{side}_hip1", (0, 1, 0), (-133, 20), 1.72, 1.27, 0.08, 0.005, -10),
            JointFigures("robot:{side}_hip2", (1, 0, 0), (-51, 17), 3.51, 1.99, 0.062, 0.005),
            JointFigures("robot:{side}_hip3", (0, 0, -1), (-32, 41), 2.16, 0.75, 0.027, 0.005),
        ),
        follows=TRUNK_HEIGHT,
        rule=".26 of hip_breadth to the side; behind and below the pelvis's middle, in proportion to its radius",
        motors=motors.UPPER_LEG_MOTORS,
        group="{side}_leg",
        matures_with="hip",
        skin_spacing_m=0.027,
        torque_site="torque_{side}_hip",
    ),
    Part(
        "{side}_lower_leg",
        "{side}_upper_leg",
        (
            GeomFigures(
                "{side}_lower_leg1",
                "capsule",
                0.3341,
                LEG_LENGTH,
                "radius = calf_circumference / 2 pi, upper half of the shank",
            ),
            GeomFigures(
                "{side}_lower_leg2",
                "capsule",
                0.1160,
                ("ankle_circumference", *LEG_LENGTH),
                "radius = ankle_circumference / 2 pi, lower half of the shank, into the foot",
            ),
        ),
        (JointFigures("robot:{side}_knee", (0, -1, 0), (-145, 4), 1.63, 0.53, 0.065, 0.003, -30),),
        follows=THIGH_LENGTH,
        rule=LEG_SHARE,
        motors=motors.LOWER_LEG_MOTORS,
        matures_with="knee",
        skin_spacing_m=0.038,
        torque_site="torque_{side}_knee",
    ),
)

WRIST_JOINTS = (
    JointFigures("robot:{side}_hand1", (0, 0, -1), (-90, 90), 0.22, 0.03, 0.007, 0.001, -20),
    JointFigures("robot:{side}_hand2", (-1, 0, 0), (-92, 86), 0.33, 0.11, 0.007, 0.001),
    JointFigures("robot:{side}_hand3", (0, 1, 0), (-53, 48), 0.38, 0.11, 0.007, 0.001),
)
"""Parts that both kinds of hands have."""

ANKLE_JOINTS = (
    JointFigures("robot:{side}_foot1", (0, -1, 0), (-63, 32), 1.29, 0.6, 0.019, 0.003, -10),
    JointFigures("robot:{side}_foot2", (1, 0, 0), (-33, 31), 0.96, 0.37, 0.011, 0.0025),
    JointFigures("robot:{side}_foot3", (0, 0, 1), (-20, 30), 1.15, 0.38, 0.012, 0.002),
)
"""Parts that both kinds of feet have."""

CHEST_JOINTS = (
    JointFigures("robot:chest_lean", (1, 0, 0), (-9, 9), 1.69, 0.38, 0.024, 0.01),
    JointFigures("robot:chest_rot", (0, 0, 1), (-18, 18), 1.45, 0.29, 0.018, 0.01),
)
"""Joints of the chest, where it is not rigidly attached."""

TENDONS: tuple[tuple[str, float, tuple[tuple[str, float], ...]], ...] = (
    ("hip_bend", 0.01, (("robot:hip_bend1", 1), ("robot:hip_bend2", -1))),
    ("hip_rotation", 0.01, (("robot:hip_rot1", 1), ("robot:hip_rot2", -1))),
    ("hip_lean", 0.01, (("robot:hip_lean1", 1), ("robot:hip_lean2", -0.5))),
    ("head_limits1", 2.1, (("robot:head_swivel", 1), ("robot:head_tilt_side", 1))),
    ("head_limits2", 2.1, (("robot:head_tilt", 1), ("robot:head_tilt_side", 1))),
    ("head_limits3", 2.1, (("robot:head_swivel", 1), ("robot:head_tilt", 1))),
    ("head_limits1_sym", 2.1, (("robot:head_swivel", 1), ("robot:head_tilt_side", -1))),
    ("head_limits2_sym", 2.1, (("robot:head_tilt", 1), ("robot:head_tilt_side", -1))),
    ("head_limits3_sym", 2.1, (("robot:head_swivel", 1), ("robot:head_tilt", -1))),
)
"""Couplings of the lumbar joints and combined limits of the head: name, half range in [rad], factors."""

EXCLUDED = (
    ("left_eye", "upper_body"),
    ("right_eye", "upper_body"),
    ("left_eye", "chest"),
    ("right_eye", "chest"),
    ("chest", "head"),
    ("hip", "upper_body"),
)
"""Pairs of bodies without contacts. MIMo's eyes would collide with the chest now that it is a separate body. Pelvis and
upper body, as deep as they were measured, would stop a bending trunk, in which a real belly folds."""
