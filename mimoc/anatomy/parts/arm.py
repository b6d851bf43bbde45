"""Upper arm and forearm: parts, joints and motors at 18 months, and their shapes."""

from mimoc.anatomy.part import (
    REST_ABDUCTION_DEG,
    SHOULDERS,
    BodyGeometry,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
    along,
)
from mimoc.anatomy.parts.trunk import behind_chest
from mimoc.anatomy.sections import SHOULDER_BACK
from mimoc.anatomy.segments import Proportions

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

ARM = (
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


KIND = PartKind("arm", "Upper arms and forearms.", ARM, arm_dimensions)
