"""Motors of all joints except fingers and toes, by the part they move: gears, and the geoms whose growth they follow.

Values are MIMo's (Mattern et al. 2024). `{side}` stands for right and left.
"""

from mimoc.body.figures import MotorFigures

LOWER_BODY_MOTORS = (
    MotorFigures("act:hip_bend", "robot:hip_bend1", 10.58, (-1, 0.765), 0.8574, "cb"),
    MotorFigures("act:hip_twist", "robot:hip_rot1", 3.63, (-1, 1), 1.699, "cb"),
    MotorFigures("act:hip_lean", "robot:hip_lean1", 7.25, (-1, 1), 1.278, "cb"),
)
CHEST_MOTORS = (
    MotorFigures("act:chest_twist", "robot:chest_rot", 0.36, (-1, 1), 1.699, "ub3"),
    MotorFigures("act:chest_lean", "robot:chest_lean", 0.72, (-1, 1), 1.278, "ub3"),
)
HEAD_MOTORS = (
    MotorFigures("act:head_swivel", "robot:head_swivel", 1.8, (-1, 1), 0.6665, "head"),
    MotorFigures("act:head_tilt", "robot:head_tilt", 3.3, (-1, 0.55), 0.9338, "head"),
    MotorFigures("act:head_tilt_side", "robot:head_tilt_side", 1.8, (-1, 1), 1.068, "head"),
)
EYE_MOTORS = (
    MotorFigures("act:{side}_eye_horizontal", "robot:{side}_eye_horizontal", 0.0054, (-1, 1), 5.11, "{side}_eye1"),
    MotorFigures("act:{side}_eye_vertical", "robot:{side}_eye_vertical", 0.0054, (-1, 1), 6.179, "{side}_eye1"),
    MotorFigures("act:{side}_eye_torsional", "robot:{side}_eye_torsional", 0.0037, (-1, 1), 25.03, "{side}_eye1"),
)
UPPER_ARM_MOTORS = (
    MotorFigures(
        "act:{side}_shoulder_horizontal", "robot:{side}_shoulder_horizontal", 1.8, (-1, 1), 1.811, "{side}_uarm1"
    ),
    MotorFigures(
        "act:{side}_shoulder_abduction", "robot:{side}_shoulder_ad_ab", 4, (-0.6875, 1), 0.8793, "{side}_uarm1"
    ),
    MotorFigures(
        "act:{side}_shoulder_internal", "robot:{side}_shoulder_rotation", 2.5, (-1, 0.64), 1.498, "{side}_uarm1"
    ),
)
LOWER_ARM_MOTORS = (MotorFigures("act:{side}_elbow", "robot:{side}_elbow", 3.6, (-1, 0.83), 1.566, "{side}_larm"),)
WRIST_MOTORS = (
    MotorFigures("act:{side}_wrist_rotation", "robot:{side}_hand1", 0.7, (-1, 1), 1.513, "{side}_hand1"),
    MotorFigures("act:{side}_wrist_flexion", "robot:{side}_hand2", 1.24, (-1, 0.57), 1.455, "{side}_hand1"),
    MotorFigures("act:{side}_wrist_ulnar", "robot:{side}_hand3", 0.95, (-0.87, 1), 2.254, "{side}_hand1"),
)
UPPER_LEG_MOTORS = (
    MotorFigures("act:{side}_hip_flex", "robot:{side}_hip1", 8, (-1, 1), 1.083, "{side}_upper_leg1"),
    MotorFigures("act:{side}_hip_abduction", "robot:{side}_hip2", 6.24, (-1, 1), 1.488, "{side}_upper_leg1"),
    MotorFigures("act:{side}_hip_rotation", "robot:{side}_hip3", 3.54, (-0.75, 1), 1.86, "{side}_upper_leg1"),
)
LOWER_LEG_MOTORS = (MotorFigures("act:{side}_knee", "robot:{side}_knee", 10, (-0.65, 1), 1.45, "{side}_lower_leg1"),)
ANKLE_MOTORS = (
    MotorFigures("act:{side}_foot_flexion", "robot:{side}_foot1", 3.78, (-1, 0.5), 1.43, "{side}_foot2"),
    MotorFigures("act:{side}_foot_inversion", "robot:{side}_foot2", 1.16, (-0.91, 1), 1.988, "{side}_foot2"),
    MotorFigures("act:{side}_foot_rotation", "robot:{side}_foot3", 1.2, (-1, 1), 2.688, "{side}_foot2"),
)
