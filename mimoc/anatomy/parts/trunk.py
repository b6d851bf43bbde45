"""Pelvis, abdomen and chest: parts, joints, motors and couplings at 18 months, and their shapes."""

from mimoc.anatomy.part import (
    ALONG_Y,
    AXIAL_RULE,
    SHOULDERS,
    TRUNK_HEIGHT,
    BodyGeometry,
    GeomShape,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
)
from mimoc.anatomy.parts.head import REFERENCE_HEAD_RADIUS_M
from mimoc.anatomy.sections import GIRDLE_BACK, Section, Trunk
from mimoc.anatomy.segments import Proportions
from mimoc.base.errors import GeometryError

REFERENCE_PELVIS_RADIUS_M = 0.059
PELVIS_X_M, CHEST_X_M = 0.008, 0.004
"""How far pelvis and chest are in front of the hip's origin in the reference body, so that backs are in line (D)."""
PELVIS_Z_M = 0.005


TRUNK = (
    ReferencePart(
        "hip",
        None,
        (
            ReferenceGeom(
                "lb",
                "capsule",
                1.1584,
                ("hip_breadth", "hip_circumference"),
                "level section with girth hip_circumference and breadth hip_breadth, both evened by up to 2 %",
                ALONG_Y,
                position_from=TRUNK_HEIGHT,
                material="pants_down",
            ),
        ),
        region="trunk",
        group="trunk",
        skin_spacing_m=0.025,
    ),
    ReferencePart(
        "lower_body",
        "hip",
        (
            ReferenceGeom(
                "cb",
                "capsule",
                1.3245,
                ("hip_breadth", "waist_circumference"),
                "level section with the girth waist_circumference and .93 of hip_breadth, both evened by up to 3 %",
                ALONG_Y,
                position_from=TRUNK_HEIGHT,
                contype=0,
                conaffinity=1,
                material="pants_up",
            ),
        ),
        (
            ReferenceJoint("robot:hip_lean1", (1, 0, 0), (-14, 14), 3.38, 0.77, 0.049, 0.01),
            ReferenceJoint("robot:hip_rot1", (0, 0, 1), (-18, 18), 1.45, 0.29, 0.018, 0.01),
            ReferenceJoint("robot:hip_bend1", (0, 1, 0), (-17, 30.5), 2.20, 0.84, 0.040, 0.01),
        ),
        position_from=TRUNK_HEIGHT,
        rule=AXIAL_RULE,
        motors=(
            ReferenceMotor("act:hip_bend", "robot:hip_bend1", 10.58, (-1, 0.765), 0.8574, "cb"),
            ReferenceMotor("act:hip_twist", "robot:hip_rot1", 3.63, (-1, 1), 1.699, "cb"),
            ReferenceMotor("act:hip_lean", "robot:hip_lean1", 7.25, (-1, 1), 1.278, "cb"),
        ),
        region="trunk",
        skin_spacing_m=0.025,
        torque_site="torque_lb",
    ),
    ReferencePart(
        "upper_body",
        "lower_body",
        (
            ReferenceGeom(
                "ub1",
                "capsule",
                1.0882,
                ("chest_breadth", "chest_circumference", *TRUNK_HEIGHT),
                "level section like the chest's, no deeper than there is room above the pelvis",
                ALONG_Y,
                material="top_down",
            ),
            ReferenceGeom(
                "ub2",
                "capsule",
                0.9499,
                ("chest_breadth", "chest_circumference"),
                "level section with girth chest_circumference and breadth chest_breadth, both evened by up to 2 %",
                ALONG_Y,
                position_from=TRUNK_HEIGHT,
                material="top_middle",
            ),
            ReferenceGeom(
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
            ReferenceJoint("robot:hip_lean2", (1, 0, 0), (-27, 27), 1.69, 0.38, 0.024, 0.01),
            ReferenceJoint("robot:hip_rot2", (0, 0, 1), (-18, 18), 1.45, 0.29, 0.018, 0.01),
            ReferenceJoint("robot:hip_bend2", (0, 1, 0), (-17, 30.5), 2.20, 0.84, 0.040, 0.01),
        ),
        position_from=TRUNK_HEIGHT,
        rule=AXIAL_RULE,
        region="trunk",
        skin_spacing_m=0.030,
        torque_site="torque_ub",
    ),
    ReferencePart(
        "chest",
        "upper_body",
        (
            ReferenceGeom(
                "ub3",
                "capsule",
                0.7217,
                SHOULDERS,
                "between the upper arms, .62 of the chest's radius",
                ALONG_Y,
                material="top_up",
            ),
        ),
        position_from=TRUNK_HEIGHT,
        rule=AXIAL_RULE,
        region="trunk",
        skin_spacing_m=0.030,
        torque_site="torque_chest",
    ),
)

CHEST_JOINTS = (
    ReferenceJoint("robot:chest_lean", (1, 0, 0), (-9, 9), 1.69, 0.38, 0.024, 0.01),
    ReferenceJoint("robot:chest_rot", (0, 0, 1), (-18, 18), 1.45, 0.29, 0.018, 0.01),
)
"""Joints of the chest, where it is not rigidly attached."""
CHEST_MOTORS = (
    ReferenceMotor("act:chest_twist", "robot:chest_rot", 0.36, (-1, 1), 1.699, "ub3"),
    ReferenceMotor("act:chest_lean", "robot:chest_lean", 0.72, (-1, 1), 1.278, "ub3"),
)

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

FOLDING = ("hip", "upper_body")
"""Pelvis and upper body, as deep as they were measured, would stop a bending trunk, in which a real belly folds."""
MIMOS_PAIRS = (("lb", "ub1"),)  # Their geoms that slide on each other by the published law (MIMo).
EXCLUDED = (
    ("left_eye", "upper_body"),
    ("right_eye", "upper_body"),
    ("left_eye", "chest"),
    ("right_eye", "chest"),
    ("chest", "head"),
    FOLDING,
)
"""Pairs of bodies without contacts. MIMo's eyes would collide with the chest now that it is a separate body."""


def trunk_dimensions(p: Proportions) -> BodyGeometry:
    """Return pelvis, abdomen, chest and shoulder girdle, and the neck of the published law."""
    t, z = p.trunk, p.trunk.axial
    depth = t.pelvis[0] / REFERENCE_PELVIS_RADIUS_M
    neck = p.head_radius_m / REFERENCE_HEAD_RADIUS_M
    bend = {
        f"robot:hip_{motion}{level}": (0.0, 0.0, -0.05 * z) for motion in ("lean", "rot", "bend") for level in (1, 2)
    }
    return BodyGeometry(
        origins={
            "hip": (0.0, 0.0, 0.0),
            "lower_body": (0.002 * depth, 0.0, 0.076 * z),
            "upper_body": (-0.002 * depth, 0.0, 0.091 * z),
            "chest": (0.0, 0.0, 0.090 * z),
        },
        shapes={
            "lb": _across(t.pelvis, PELVIS_X_M * depth, PELVIS_Z_M * z),
            "cb": _across(t.waist, 0.008 * depth, -0.008 * z),
            "ub1": _across(t.belly, 0.007 * depth, -0.024 * z),
            "ub2": _across(t.ribs, CHEST_X_M * depth, 0.030 * z),
            "neck": GeomShape((0.028 * neck, 0.02 * z), (-0.004 * neck, 0.0, 0.125 * z)),
            "ub3": _across(t.girdle, behind_chest(t, GIRDLE_BACK), 0.0),
        },
        anchors=bend,
    )


def _across(section: Section, x_m: float, z_m: float) -> GeomShape:
    radius_m, half_width_m = section
    if half_width_m <= radius_m:
        raise GeometryError(f"a trunk {2 * half_width_m:.3f} m wide cannot be {2 * radius_m:.3f} m deep")
    return GeomShape((radius_m, half_width_m - radius_m), (x_m, 0.0, z_m))


def behind_chest(t: Trunk, radii: float) -> float:
    """Return the x of what is some radii of the chest behind its middle, in the frame of the chest."""
    return CHEST_X_M * t.pelvis[0] / REFERENCE_PELVIS_RADIUS_M - radii * t.ribs[0]


KIND = PartKind("trunk", "Pelvis, abdomen and chest.", TRUNK, trunk_dimensions, excluded=EXCLUDED)
