"""Mitten hands, whose fingers move together, and feet whose toes do (Mattern et al. 2024).

Names with `{side}` stand for a right and a left part; values are those of the right side.
"""

from mimoc.body.anatomy import ANKLE_JOINTS, WRIST_JOINTS
from mimoc.body.figures import (
    ALONG_X,
    ALONG_Y,
    LEG_LENGTH,
    LEG_SHARE,
    WRIST,
    GeomFigures,
    JointFigures,
    MotorFigures,
    Part,
)
from mimoc.body.motors import ANKLE_MOTORS, WRIST_MOTORS

_HAND_GRIP = (5.0, 0.02, 0.01)
_SOLE_GRIP = (2.0, 0.02, 0.01)

FINGER_MOTORS = (MotorFigures("act:{side}_fingers", "robot:{side}_fingers", 0.69, (-1, 0.33), 3.019, "{side}_hand1"),)
TOE_MOTORS = (MotorFigures("act:{side}_toes", "robot:{side}_toes", 0.33, (-1, 0.3), 1.29, "{side}_foot2"),)

HAND = (
    Part(
        "{side}_hand",
        "{side}_lower_arm",
        (
            GeomFigures(
                "{side}_hand1",
                "box",
                0.04315,
                ("maximum_fist_breadth", "hand_length", "hand_breadth"),
                "as wide as maximum_fist_breadth, half of hand_length less the fingertip's radius",
            ),
            GeomFigures(
                "{side}_hand2",
                "cylinder",
                0.01602,
                ("maximum_fist_breadth", "hand_length", "hand_breadth"),
                "rounds the palm off at the knuckles",
                ALONG_X,
            ),
        ),
        WRIST_JOINTS,
        follows=WRIST,
        rule="elbow_hand_length less hand_length and the flesh behind the elbow, which is as thick as the arm",
        motors=WRIST_MOTORS,
        group="{side}_hand",
        skin_spacing_m=0.007,
        torque_site="torque_{side}_wrist",
    ),
    Part(
        "{side}_fingers",
        "{side}_hand",
        (
            GeomFigures(
                "{side}_fingers1",
                "box",
                0.03494,
                ("hand_breadth", "hand_length"),
                "as wide as hand_breadth, half of hand_length less the fingertip's radius",
                friction=_HAND_GRIP,
            ),
            GeomFigures(
                "{side}_fingers2",
                "cylinder",
                0.01323,
                ("hand_breadth", "hand_length"),
                "rounds the fingertips off at hand_length from the wrist",
                ALONG_X,
                _HAND_GRIP,
            ),
        ),
        (JointFigures("robot:{side}_fingers", (-1, 0, 0), (-160, 8), 0.017, 0.018, 0.0023, 0.0001, -40),),
        follows=("hand_length", "hand_breadth"),
        rule="at the knuckles, half of hand_length less the fingertip's radius",
        motors=FINGER_MOTORS,
        skin_spacing_m=0.002,
        torque_site="torque_{side}_fingers",
    ),
)

FOOT = (
    Part(
        "{side}_foot",
        "{side}_lower_leg",
        (
            GeomFigures(
                "{side}_foot1",
                "cylinder",
                0.03219,
                ("foot_breadth", "foot_length"),
                "heel, as wide as foot_breadth",
            ),
            GeomFigures(
                "{side}_foot2",
                "box",
                0.05850,
                ("foot_breadth", "foot_length"),
                "sole, as wide as foot_breadth",
                friction=_SOLE_GRIP,
            ),
            GeomFigures(
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
        follows=LEG_LENGTH,
        rule=LEG_SHARE,
        motors=ANKLE_MOTORS,
        matures_with="ankle",
        skin_spacing_m=0.015,
        torque_site="torque_{side}_ankle",
        lies=True,
    ),
)

TOES = (
    Part(
        "{side}_toes",
        "{side}_foot",
        (
            GeomFigures(
                "{side}_toes1",
                "box",
                0.01084,
                ("foot_breadth", "foot_length"),
                "toes, as wide as foot_breadth",
                friction=_SOLE_GRIP,
            ),
            GeomFigures(
                "{side}_toes2",
                "cylinder",
                0.01226,
                ("foot_breadth", "foot_length"),
                "rounds the toes off at foot_length from the heel",
                ALONG_Y,
                _SOLE_GRIP,
            ),
        ),
        (JointFigures("robot:{side}_toes", (0, -1, 0), (-60, 80), 0.106, 0.04, 0.005, 0.0005),),
        follows=("foot_length", "foot_breadth"),
        rule="in proportion to the foot",
        motors=TOE_MOTORS,
        skin_spacing_m=0.010,
        torque_site="torque_{side}_toes",
        lies=True,
    ),
)
