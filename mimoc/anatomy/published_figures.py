"""Figures of MIMo's reference body that only the published law needs, and the rules that provenance tells."""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.anatomy.part import ReferenceGeom, ReferenceMotor, ReferencePart

Sizes = Mapping[str, tuple[float, ...]]
Names = tuple[str, ...]

SIZES_M: Sizes = {
    "lb": (0.048, 0.043),
    "cb": (0.053, 0.035),
    "ub1": (0.052, 0.035),
    "ub2": (0.048, 0.039),
    "ub3": (0.041, 0.047),
    "neck": (1e-6, 1e-6),
    "head": (0.0735,),
    "{side}_eye1": (0.01125,),
    "{side}_uarm1": (0.024, 0.0536),
    "{side}_larm": (0.023, 0.037),
    "{side}_hand1": (0.0281, 0.01, 0.0208),
    "{side}_hand2": (0.0102, 0.0278),
    "{side}_fingers1": (0.0228, 0.01, 0.0207),
    "{side}_fingers2": (0.0102, 0.023),
    "{side}_upper_leg1": (0.037, 0.0625),
    "{side}_lower_leg1": (0.029, 0.044),
    "{side}_lower_leg2": (0.021, 0.028),
    "{side}_foot1": (0.0249, 0.0099),
    "{side}_foot2": (0.035, 0.025, 0.01),
    "{side}_foot3": (0.0099, 0.0248),
    "{side}_toes1": (0.007, 0.0249, 0.0099),
    "{side}_toes2": (0.01, 0.025),
}
"""Sizes of the geoms of MIMo's reference body (Mattern et al. 2024), at which they have their masses, and motors their
torques; those of five-finger hands stand in their kind."""
TWO_TOED_SIZES_M: Sizes = {
    "{side}_foot1": (0.0249, 0.0101),
    "{side}_foot2": (0.030, 0.025, 0.01),
    "{side}_foot3": (0.0101, 0.0251),
    "{side}_toes1": (0.0095, 0.016, 0.0099),
    "{side}_toes2": (0.01, 0.0165),
    "{side}_big_toe1": (0.0095, 0.007, 0.0099),
    "{side}_big_toe2": (0.01, 0.0075),
}
"""Sizes of the feet of the body with five fingers."""
ARM_DEG = (170.0, 0.0, 0.0)
"""Turn of hanging right upper arms when all joints are at zero: 10 degrees from the vertical."""

FMAX: Mapping[str, tuple[float, float]] = {
    "hip_bend": (32.93, 22.97),
    "hip_twist": (8.136, 8.136),
    "hip_lean": (1.264, 1.264),
    "chest_twist": (8.136, 8.136),
    "chest_lean": (1.264, 1.264),
    "head_swivel": (24.87, 24.87),
    "head_tilt": (31.39, 16.86),
    "head_tilt_side": (15.69, 15.69),
    "eye_horizontal": (0.03025, 0.03025),
    "eye_vertical": (0.02619, 0.02771),
    "eye_torsional": (0.003686, 0.003686),
    "shoulder_horizontal": (18.80, 15.30),
    "shoulder_abduction": (44.17, 69.23),
    "shoulder_internal": (25.09, 17.10),
    "elbow": (35.43, 27.04),
    "wrist_rotation": (7.842, 7.842),
    "wrist_flexion": (13.66, 7.874),
    "wrist_ulnar": (5.155, 6.021),
    "fingers": (6.854, 2.551),
    "ff_side": (0.1556, 0.1556),
    "ff_knuckle": (0.1422, 0.4378),
    "ff_middle": (0.04684, 0.1339),
    "ff_distal": (0.03054, 0.07747),
    "mf_side": (0.1556, 0.1556),
    "mf_knuckle": (0.2687, 0.8275),
    "mf_middle": (0.08855, 0.2532),
    "mf_distal": (0.05771, 0.1464),
    "rf_side": (0.1556, 0.1556),
    "rf_knuckle": (0.1791, 0.5517),
    "rf_middle": (0.05903, 0.1688),
    "rf_distal": (0.03847, 0.09759),
    "lf_side": (0.1556, 0.1556),
    "lf_meta": (0.07962, 0.1508),
    "lf_knuckle": (0.04502, 0.1386),
    "lf_middle": (0.01483, 0.04239),
    "lf_distal": (0.009666, 0.02452),
    "thumb_side": (1.117, 2.604),
    "thumb_add": (0.4969, 0.5024),
    "thumb_pivot": (0.1868, 0.1868),
    "thumb_middle": (0.2433, 0.7065),
    "thumb_distal": (0.2053, 0.4959),
    "hip_flex": (71.25, 92.49),
    "hip_abduction": (24.81, 29.20),
    "hip_rotation": (12.32, 15.78),
    "knee": (63.16, 89.27),
    "foot_flexion": (21.34, 11.87),
    "foot_inversion": (4.184, 4.645),
    "foot_rotation": (3.868, 3.625),
    "toes": (2.947, 0.8440),
}
"""FMAX of the muscles in each motor's place, towards negative and positive angles (Mattern et al. 2024)."""
HALF_OF_TOES_FMAX = (1.473, 0.4220)  # FMAX of the big toe, and of the other toes beside it.

DEFECTS: Mapping[str, str] = {
    "curves": "the curves were fitted without newborns, and with children of 3 to 5 months at 3: three of them fall "
    "off a cliff below a month, and from birth to one month the body gains 7.9 cm and 71 % of its mass",
    "trunk": "heights of the trunk follow hip_breadth, so that sitting height over height rises, then falls",
    "knee": "the knee is at twice the radius and half of the length of a thigh that ends at one radius and its length",
    "arm": "upper arm and forearm get shorter during the first month",
    "shoulder": "the shoulders are 11 mm too far in, so that hanging arms are in the chest at every age",
    "reference": "at 18 months it is not the reference body, but 3.7 % heavier, with feet 4 mm longer (14 with five "
    "fingers), and fingers with .5 to .7 of its volume and strength",
    "constant": "strengths of muscles, cameras and several places do not grow",
}
"""What is wrong with the published body, by topic; its figures were measured on that body."""


def published_part(part: ReferencePart, two_toed: bool) -> ReferencePart:
    """Return a part as it is by the published law: MIMo's sizes at its masses, its muscles, and rules for provenance.

    Parts that are not MIMo's stay as they are.
    """
    position_from, rule = PLACES.get(part.name, (part.position_from, part.rule))
    return replace(
        part,
        geoms=tuple(_geom(geom, two_toed) for geom in part.geoms),
        motors=tuple(_motor(motor, two_toed) for motor in part.motors),
        euler_deg=ARM_DEG if part.name == "{side}_upper_arm" else part.euler_deg,
        position_from=position_from,
        rule=rule,
    )


def _geom(geom: ReferenceGeom, two_toed: bool) -> ReferenceGeom:
    size_from, position_from, rule = RULES.get(geom.name, (geom.size_from, geom.position_from, geom.rule))
    sizes_m = {**SIZES_M, **TWO_TOED_SIZES_M} if two_toed else SIZES_M
    is_of_fingers_or_foot = geom.mass_at_m or "foot" in geom.name or "toe" in geom.name
    return replace(
        geom,
        mass_at_m=geom.mass_at_m or sizes_m.get(geom.name, ()),
        size_from=size_from,
        position_from=position_from,
        rule=rule + as_published("reference") if is_of_fingers_or_foot else rule,
    )


def _motor(motor: ReferenceMotor, two_toed: bool) -> ReferenceMotor:
    name = motor.name.removeprefix("act:").removeprefix("{side}_")
    return replace(motor, fmax=HALF_OF_TOES_FMAX if two_toed and "toe" in name else FMAX.get(name, ()))


def as_published(topic: str) -> str:
    """Return what is said of a number that has one of the defects."""
    return f"; as published: {DEFECTS[topic]}"


_HIP, _HEAD = "MIMo's x hip_breadth / 17.1 cm", "MIMo's x head_circumference / 46.8 cm"
_TRUNK = ("hip_breadth",), _HIP + "; its x does not grow" + as_published("trunk")
_WRIST = ("forearm_circumference", "elbow_hand_length", "hand_length")
_LIMB = "radius: MIMo's x {girth}; half length: MIMo's x ({length}) / 2 less {girth} / 2 pi, all relative to MIMo's"
_ARM_RULE = _LIMB.format(girth="upper_arm_circumference", length="shoulder_elbow_length")
_FOREARM_RULE = _LIMB.format(girth="forearm_circumference", length="elbow_hand_length - hand_length")
_THIGH_RULE = _LIMB.format(girth="mid_thigh_circumference", length="rump_knee_length")
_SHANK = "radius = {0}_circumference / 2 pi; half length: MIMo's x knee_sole_length / 21.6 cm"

RULES: Mapping[str, tuple[Names, Names, str]] = {
    **dict.fromkeys(("lb", "cb", "ub1", "ub2", "ub3"), (("hip_breadth",), (), _HIP)),
    "neck": (("head_circumference",), ("hip_breadth",), "a ball below the head that weighs nothing"),
    "head": (("head_circumference",), (), _HEAD),
    "{side}_eye1": (("head_circumference",), (), _HEAD),
    "{side}_uarm1": (("upper_arm_circumference", "shoulder_elbow_length"), (), _ARM_RULE + as_published("arm")),
    "{side}_larm": (_WRIST, (), _FOREARM_RULE + as_published("arm")),
    "{side}_upper_leg1": (("mid_thigh_circumference", "rump_knee_length"), (), _THIGH_RULE),
    "{side}_lower_leg1": (("calf_circumference", "knee_sole_length"), (), _SHANK.format("calf")),
    "{side}_lower_leg2": (("ankle_circumference", "knee_sole_length"), (), _SHANK.format("ankle")),
}
"""By geom: the measurements that its size follows, those that only its place does, and how, for people. Those of hands
and feet follow the same measurements by either law."""

_KNUCKLE = ("hand_breadth", "hand_length", "middle_finger_diameter"), "where the palm ends"

PLACES: Mapping[str, tuple[Names, str]] = {
    **dict.fromkeys(("lower_body", "upper_body", "chest", "head"), _TRUNK),
    "{side}_eye": (("head_circumference",), _HEAD),
    "{side}_upper_arm": (
        ("hip_breadth", "upper_arm_circumference"),
        ".088 m x hip_breadth / 17.1 cm and a quarter of its radius to the side" + as_published("shoulder"),
    ),
    "{side}_lower_arm": (
        ("upper_arm_circumference", "shoulder_elbow_length"),
        "twice the half length of the upper arm" + as_published("arm"),
    ),
    "{side}_hand": ((*_WRIST, "hand_breadth"), "in proportion to radius and length of the forearm"),
    "{side}_fingers": (("hand_length",), "MIMo's x hand_length / 9.3 cm"),
    "{side}_ffknuckle": _KNUCKLE,
    "{side}_rfknuckle": _KNUCKLE,
    "{side}_upper_leg": (
        ("hip_breadth",),
        ".051 m x hip_breadth / 17.1 cm to the side; x and z do not grow" + as_published("constant"),
    ),
    "{side}_lower_leg": (
        ("mid_thigh_circumference", "rump_knee_length"),
        "twice the radius and the half length of the thigh below the hip joint" + as_published("knee"),
    ),
    "{side}_foot": (("knee_sole_length",), ".176 m x knee_sole_length / 21.6 cm below the knee"),
}
"""By part: the measurements that its place in its parent follows, and how."""
