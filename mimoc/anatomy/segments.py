"""Lengths and radii of an infant's segments, from measurements of a child.

Measurements are taken on the surface of a child, whereas segments of a model run between joints. Where the two
differ, the segment is the same fraction of the measurement as in the reference body, whose measurements are the means
of the 16-19 months group of AnthroKids.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.anatomy.sections import CLEARANCE_M, NO_ROOM, Trunk, axial_spacing, measured_trunk
from mimoc.base.errors import GeometryError
from mimoc.base.geometry.primitives import ellipse_perimeter


def _mimos_trunk(m: Mapping[str, float], head_radius_m: float, arm_radius_m: float) -> Trunk:
    """Return MIMo's trunk: widths from breadths, depths from girths, height from crown-rump length and head.

    It is MIMo's with its growth corrected: as deep as girths are in proportion to MIMo's, and with shoulder joints as
    far apart as shoulders are broad. By the law `maturing`, strength and masses follow the volumes of these shapes;
    bodies have other ones (`measured_trunk`), which have the measured girths, breadths and lengths.
    """
    pelvis_radius_m = 0.048 * share(m, "hip_circumference")
    belly_scale = share(m, "chest_circumference")
    shoulder_y_m = m["shoulder_breadth"] / 2
    axial = axial_spacing(m["crown_rump_length"], head_radius_m, pelvis_radius_m)
    belly_radius_m = min(0.052 * belly_scale, 0.129 * axial - pelvis_radius_m)
    if belly_radius_m <= 0.013 * belly_scale:
        raise GeometryError(NO_ROOM)
    return Trunk(
        axial=axial,
        pelvis=(pelvis_radius_m, m["hip_breadth"] / 2),
        waist=(0.053 * share(m, "waist_circumference"), (m["hip_breadth"] + m["chest_breadth"]) / 4),
        belly=(belly_radius_m, m["chest_breadth"] / 2),
        ribs=(0.048 * belly_scale, m["chest_breadth"] / 2),
        girdle=(0.041 * belly_scale, shoulder_y_m - arm_radius_m - CLEARANCE_M),
        shoulder_y_m=shoulder_y_m,
        arm_inwards_m=0.0,
        hip_y_m=0.051 * share(m, "hip_breadth"),
        rump_m=pelvis_radius_m - 0.012 * axial,
        buttocks_m=pelvis_radius_m,
    )


def _mimos_leg(
    m: Mapping[str, float], base: Mapping[str, float], leg_m: float, foot_height_m: float
) -> tuple[float, float]:
    """Return the lengths of MIMo's thigh and shank, which add up to *leg_m*; *foot_height_m* is half of the height.

    They are in proportion to rump-knee and knee-sole length, as in the reference body; if one of these was replaced,
    its segment changes in the same proportion.
    """
    thigh_m = 0.135 * share(base, "rump_knee_length")
    shank_m = 0.187 * share(base, "knee_sole_length") - foot_height_m
    unit_m = leg_m / (thigh_m + shank_m)
    return (
        unit_m * thigh_m * m["rump_knee_length"] / base["rump_knee_length"],
        unit_m * shank_m * m["knee_sole_length"] / base["knee_sole_length"],
    )


def share(m: Mapping[str, float], name: str) -> float:
    """Return a measurement as a multiple of the reference child's."""
    return m[name] / REFERENCE_M[name]


REFERENCE_M: Mapping[str, float] = {
    "chest_circumference": 0.468,
    "elbow_hand_length": 0.207,
    "foot_breadth": 0.050,
    "foot_length": 0.119,
    "forearm_circumference": 0.145,
    "hand_breadth": 0.046,
    "hand_length": 0.093,
    "head_circumference": 0.468,
    "hip_breadth": 0.171,
    "hip_circumference": 0.477,
    "knee_sole_length": 0.216,
    "maximum_fist_breadth": 0.055,
    "mid_thigh_circumference": 0.244,
    "rump_knee_length": 0.213,
    "shoulder_elbow_length": 0.154,
    "upper_arm_circumference": 0.147,
    "waist_circumference": 0.431,
}
"""The reference child, about 18 months old (AnthroKids, 16-19 completed months)."""

UPPER_ARM_FLESH, FOREARM_FLESH, THIGH_FLESH, SHANK_FLESH = 0.35, 0.25, 0.385, 0.175
"""Largest shares of shoulder-elbow, elbow-wrist, rump-knee and knee-sole length that are flesh beyond the joints: a
little more than in the average child of any age. Stout children's limbs are longer than their thickness leaves (D)."""

KNEE_FORWARD = 0.6
"""How far the knee joint is in front of the thigh's axis, as a share of what the thigh is thicker than the calf (D)."""

FINGER_ROOM, THUMB_ROOM = 0.062, 0.073
"""Largest ratio of radius to hand length at which the phalanges of a straight finger do not touch their neighbours."""


@dataclass(frozen=True, slots=True)
class Limb:
    """A segment from joint to joint."""

    length_m: float
    radius_m: float


@dataclass(frozen=True, slots=True)
class Hand:
    """A hand: palm and fingers."""

    length_m: float  # Wrist to fingertips.
    half_breadth_m: float  # Across the knuckles.
    half_fist_m: float  # Across the fist, thumb included.
    half_thickness_m: float
    finger_radius_m: float  # Radius of the middle finger.
    thumb_radius_m: float


@dataclass(frozen=True, slots=True)
class Foot:
    """A flat foot."""

    length_m: float
    half_breadth_m: float
    half_height_m: float


@dataclass(frozen=True, slots=True)
class Proportions:
    """Proportions that determine all shapes of an infant."""

    head_radius_m: float  # Radius of a circle with the head's circumference.
    head_half_axes_m: tuple[float, float]
    """Half axes of the head's level section, an ellipse with the same circumference: half its length and breadth."""
    trunk: Trunk
    upper_arm: Limb
    forearm: Limb
    hand: Hand
    thigh: Limb
    shank: Limb  # Knee to the middle of the foot; the radius is that of the calf.
    knee_forward_m: float  # How far the knee joint is in front of the thigh's axis.
    ankle_radius_m: float
    foot: Foot


def proportions(
    m: Mapping[str, float], base: Mapping[str, float], mimos: bool = False, foot_height: float = 1.0
) -> Proportions:
    """Return the proportions of a child, or of one of its sides; raise a GeometryError if measurements do not fit.

    Measurements are in [m], by AnthroKids name; *base* has them before any was replaced. With *mimos*, trunk and limbs
    are those whose volumes strength and masses follow; *foot_height* is relative to MIMo's, and the legs are as much
    shorter.
    """
    head_radius_m = radius_of(m["head_circumference"])
    arm_radius_m = radius_of(m["upper_arm_circumference"])
    foot = _foot(m, foot_height)
    if mimos:
        trunk = _mimos_trunk(m, head_radius_m, arm_radius_m)
        # In the reference body's proportion to measured lengths.
        to_wrist_m, reference_m = (of["elbow_hand_length"] - of["hand_length"] for of in (m, REFERENCE_M))
        upper_arm_m = 0.1076 * share(m, "shoulder_elbow_length")
        forearm_m = 0.087 * to_wrist_m / reference_m
        thigh_m, shank_m = _mimos_leg(m, base, _leg_length(m, trunk, foot), foot.half_height_m)
    else:
        trunk = measured_trunk(m, base, head_radius_m, arm_radius_m)
        upper_arm_m, forearm_m = _arm(m)
        thigh_m, shank_m = _leg(m, base, trunk, foot)
    thigh = Limb(thigh_m, radius_of(m["mid_thigh_circumference"]))
    shank = Limb(shank_m, radius_of(m["calf_circumference"]))
    # Head length and breadth, both by the factor that gives the circumference.
    factor = m["head_circumference"] / ellipse_perimeter(m["head_length"] / 2, m["head_breadth"] / 2)
    return Proportions(
        head_radius_m=head_radius_m,
        head_half_axes_m=(factor * m["head_length"] / 2, factor * m["head_breadth"] / 2),
        trunk=trunk,
        upper_arm=Limb(upper_arm_m, arm_radius_m),
        forearm=Limb(forearm_m, radius_of(m["forearm_circumference"])),
        hand=Hand(
            length_m=m["hand_length"],
            half_breadth_m=m["hand_breadth"] / 2,
            half_fist_m=m["maximum_fist_breadth"] / 2,
            half_thickness_m=hand_half_thickness(m),
            finger_radius_m=_finger_radius(m, base, "middle_finger_diameter", FINGER_ROOM),
            thumb_radius_m=_finger_radius(m, base, "thumb_diameter", THUMB_ROOM),
        ),
        thigh=thigh,
        shank=shank,
        knee_forward_m=KNEE_FORWARD * max(0.0, thigh.radius_m - shank.radius_m),
        ankle_radius_m=radius_of(m["ankle_circumference"]),
        foot=foot,
    )


def _arm(m: Mapping[str, float]) -> tuple[float, float]:
    """Return the lengths of upper arm and forearm between the joints.

    Shoulder-elbow length is taken from the top of the shoulder to below the bent elbow, elbow-hand length from behind
    it to the fingertips.
    """
    upper_radius_m, radius_m = (radius_of(m[f"{part}_circumference"]) for part in ("upper_arm", "forearm"))
    whole_m = m["shoulder_elbow_length"]
    to_wrist_m = m["elbow_hand_length"] - m["hand_length"]
    beyond_m = min(upper_radius_m + radius_m, UPPER_ARM_FLESH * whole_m)
    behind_m = min(max(upper_radius_m, radius_m), FOREARM_FLESH * to_wrist_m)
    return whole_m - beyond_m, to_wrist_m - behind_m


def _finger_radius(m: Mapping[str, float], base: Mapping[str, float], name: str, room: float) -> float:
    return m[name] / 2 if m[name] != base[name] else min(m[name] / 2, room * m["hand_length"])


def hand_half_thickness(m: Mapping[str, float]) -> float:
    """Return half of the thickness of a hand, MIMo's in proportion to its length and breadth, in [m]."""
    return 0.01 * ((m["hand_length"] + m["hand_breadth"]) / (REFERENCE_M["hand_length"] + REFERENCE_M["hand_breadth"]))


def _foot(m: Mapping[str, float], relative_height: float) -> Foot:
    return Foot(m["foot_length"], m["foot_breadth"] / 2, foot_half_height(m) * relative_height)


def foot_half_height(m: Mapping[str, float]) -> float:
    """Return half of the height of a foot, MIMo's in proportion to its length and breadth, in [m]."""
    return 0.01 * ((m["foot_length"] + m["foot_breadth"]) / (REFERENCE_M["foot_length"] + REFERENCE_M["foot_breadth"]))


def _leg(m: Mapping[str, float], base: Mapping[str, float], trunk: Trunk, foot: Foot) -> tuple[float, float]:
    """Return the lengths of thigh and shank, which add up to the part of crown-sole length below the hip joint.

    It is divided such that rump-knee and knee-sole length, taken on the sitting child, are in their measured
    proportion; if one of these was replaced, the segment changes by as much.
    """
    leg_m = _leg_length(m, trunk, foot)
    thigh_radius_m, calf_radius_m = (radius_of(base[f"{part}_circumference"]) for part in ("mid_thigh", "calf"))
    behind_m = min(trunk.buttocks_m + calf_radius_m, THIGH_FLESH * base["rump_knee_length"])
    above_m = thigh_radius_m - KNEE_FORWARD * max(0.0, thigh_radius_m - calf_radius_m)
    above_m = min(above_m, SHANK_FLESH * base["knee_sole_length"]) + foot.half_height_m
    unit = (leg_m + behind_m + above_m) / (base["rump_knee_length"] + base["knee_sole_length"])
    thigh_m, shank_m = unit * m["rump_knee_length"] - behind_m, unit * m["knee_sole_length"] - above_m
    if min(thigh_m, shank_m) <= 0:
        raise GeometryError("rump_knee_length and knee_sole_length leave no room for thigh and shank")
    return thigh_m, shank_m


def _leg_length(m: Mapping[str, float], trunk: Trunk, foot: Foot) -> float:
    leg_m = m["crown_sole_length"] - m["crown_rump_length"] + trunk.rump_m - foot.half_height_m
    if leg_m <= 0:
        raise GeometryError("crown_sole_length leaves no room for legs below this trunk")
    return leg_m


def radius_of(circumference_m: float) -> float:
    """Return the radius of a circle, in [m]."""
    return circumference_m / (2 * math.pi)
