"""Lengths and radii of an infant's segments, from measurements of a child.

Measurements are taken on the surface of a child, whereas segments of a model run between joints. Where the two
differ, the segment is the same fraction of the measurement as in the reference body, whose measurements are the means
of the 16-19 months group of AnthroKids.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.errors import GeometryError
from mimoc.geometry.ellipsoids import ellipse_perimeter

REFERENCE_M: Mapping[str, float] = {
    "chest_circumference": 0.468,
    "elbow_hand_length": 0.207,
    "foot_breadth": 0.050,
    "foot_length": 0.119,
    "hand_breadth": 0.046,
    "hand_length": 0.093,
    "hip_breadth": 0.171,
    "hip_circumference": 0.477,
    "knee_sole_length": 0.216,
    "rump_knee_length": 0.213,
    "shoulder_elbow_length": 0.154,
    "waist_circumference": 0.431,
}
"""The reference child, about 18 months old (AnthroKids, 16-19 completed months)."""

CLEARANCE_M = 1e-4
"""Distance by which a part is made smaller than its neighbour where their surfaces would coincide (MIMo v2)."""

FINGER_ROOM, THUMB_ROOM = 0.062, 0.073
"""Largest ratio of radius to hand length at which the phalanges of a straight finger do not touch their neighbours."""


@dataclass(frozen=True, slots=True)
class Trunk:
    """Pelvis to shoulders: radius and half width of each capsule, and their spacing."""

    axial: float
    """Spacing of the trunk's bodies along z, 1 in the reference body."""
    pelvis: tuple[float, float]
    """Radius and half width, in [m], as for the fields below."""
    waist: tuple[float, float]
    belly: tuple[float, float]
    ribs: tuple[float, float]
    girdle: tuple[float, float]
    shoulder_y_m: float
    """Distance from the midline to the shoulder joint."""
    hip_y_m: float
    """Distance from the midline to the hip joint."""


@dataclass(frozen=True, slots=True)
class Limb:
    """A segment from joint to joint."""

    length_m: float
    radius_m: float


@dataclass(frozen=True, slots=True)
class Hand:
    """A hand: palm and fingers."""

    length_m: float
    """Wrist to fingertips."""
    half_breadth_m: float
    """Across the knuckles."""
    half_fist_m: float
    """Across the fist, thumb included."""
    half_thickness_m: float
    finger_radius_m: float
    """Of the middle finger."""
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

    head_radius_m: float
    """Of a circle with the head's circumference."""
    head_half_axes_m: tuple[float, float]
    """Of the head's level section, an ellipse with the same circumference: half its length and half its breadth."""
    trunk: Trunk
    upper_arm: Limb
    forearm: Limb
    hand: Hand
    thigh: Limb
    shank: Limb
    """Knee to the middle of the foot; the radius is that of the calf."""
    ankle_radius_m: float
    foot: Foot


def proportions(m: Mapping[str, float], base: Mapping[str, float], foot_height: float = 1.0) -> Proportions:
    """Return the proportions of a child, or of one of its sides.

    Args:
        m: Measurements in [m], by AnthroKids name.
        base: The same before any of them was replaced: the reference for replaced lengths of the leg.
        foot_height: Height of the feet relative to MIMo's; the legs are as much shorter.

    Raises:
        GeometryError: If a measurement does not fit the others.
    """
    head_radius_m = _radius(m["head_circumference"])
    upper_arm = Limb(0.1076 * _share(m, "shoulder_elbow_length"), _radius(m["upper_arm_circumference"]))
    trunk = _trunk(m, head_radius_m, upper_arm.radius_m)
    foot = _foot(m, foot_height)
    thigh_length_m, shank_length_m = _leg(m, base, trunk, foot)
    return Proportions(
        head_radius_m=head_radius_m,
        head_half_axes_m=_head_half_axes(m),
        trunk=trunk,
        upper_arm=upper_arm,
        forearm=Limb(_forearm_length(m), _radius(m["forearm_circumference"])),
        hand=_hand(m, base),
        thigh=Limb(thigh_length_m, _radius(m["mid_thigh_circumference"])),
        shank=Limb(shank_length_m, _radius(m["calf_circumference"])),
        ankle_radius_m=_radius(m["ankle_circumference"]),
        foot=foot,
    )


def _trunk(m: Mapping[str, float], head_radius_m: float, arm_radius_m: float) -> Trunk:
    """Return the trunk: its width from breadths, its depth from girths, its height from crown-rump length and head.

    The distance from belly to pelvis is .130 axial, which limits the depth of the belly in a stout child.
    The lowest point of the pelvis lies one radius below .005 axial, the head's at .302 axial, both
    from the hip's origin: that and the crown-rump length give the axial spacing.
    """
    pelvis_radius_m = 0.048 * _share(m, "hip_circumference")
    belly_scale = _share(m, "chest_circumference")
    shoulder_y_m = m["shoulder_breadth"] / 2
    axial = (m["crown_rump_length"] - 2 * head_radius_m - pelvis_radius_m) / (0.302 - 0.005)
    belly_radius_m = min(0.052 * belly_scale, 0.129 * axial - pelvis_radius_m)
    if belly_radius_m <= 0.013 * belly_scale:
        raise GeometryError("crown_rump_length leaves no room for a trunk below this head")
    return Trunk(
        axial=axial,
        pelvis=(pelvis_radius_m, m["hip_breadth"] / 2),
        waist=(0.053 * _share(m, "waist_circumference"), (m["hip_breadth"] + m["chest_breadth"]) / 4),
        belly=(belly_radius_m, m["chest_breadth"] / 2),
        ribs=(0.048 * belly_scale, m["chest_breadth"] / 2),
        girdle=(0.041 * belly_scale, shoulder_y_m - arm_radius_m - CLEARANCE_M),
        shoulder_y_m=shoulder_y_m,
        hip_y_m=0.051 * _share(m, "hip_breadth"),
    )


def _forearm_length(m: Mapping[str, float]) -> float:
    reference_m = REFERENCE_M["elbow_hand_length"] - REFERENCE_M["hand_length"]
    return 0.087 * (m["elbow_hand_length"] - m["hand_length"]) / reference_m


def _hand(m: Mapping[str, float], base: Mapping[str, float]) -> Hand:
    """Return a hand; in a stout child the thickness of fingers is limited by their spacing, unless it is given."""
    thickness = (m["hand_length"] + m["hand_breadth"]) / (REFERENCE_M["hand_length"] + REFERENCE_M["hand_breadth"])
    return Hand(
        length_m=m["hand_length"],
        half_breadth_m=m["hand_breadth"] / 2,
        half_fist_m=m["maximum_fist_breadth"] / 2,
        half_thickness_m=0.01 * thickness,
        finger_radius_m=_finger_radius(m, base, "middle_finger_diameter", FINGER_ROOM),
        thumb_radius_m=_finger_radius(m, base, "thumb_diameter", THUMB_ROOM),
    )


def _finger_radius(m: Mapping[str, float], base: Mapping[str, float], name: str, room: float) -> float:
    return m[name] / 2 if m[name] != base[name] else min(m[name] / 2, room * m["hand_length"])


def _foot(m: Mapping[str, float], relative_height: float) -> Foot:
    height = (m["foot_length"] + m["foot_breadth"]) / (REFERENCE_M["foot_length"] + REFERENCE_M["foot_breadth"])
    return Foot(m["foot_length"], m["foot_breadth"] / 2, 0.01 * height * relative_height)


def _head_half_axes(m: Mapping[str, float]) -> tuple[float, float]:
    """Return half of head_length and half of head_breadth, both by the factor that gives head_circumference."""
    factor = m["head_circumference"] / ellipse_perimeter(m["head_length"] / 2, m["head_breadth"] / 2)
    return factor * m["head_length"] / 2, factor * m["head_breadth"] / 2


def _leg(m: Mapping[str, float], base: Mapping[str, float], trunk: Trunk, foot: Foot) -> tuple[float, float]:
    """Return the lengths of thigh and shank, which add up to the part of crown-sole length below the hip joint.

    It is divided in proportion to rump-knee and knee-sole length, as in the reference body; if one of these was
    replaced, its segment changes in the same proportion.
    """
    hip_to_rump_m = trunk.pelvis[0] - 0.012 * trunk.axial
    leg_m = m["crown_sole_length"] - m["crown_rump_length"] + hip_to_rump_m - foot.half_height_m
    if leg_m <= 0:
        raise GeometryError("crown_sole_length leaves no room for legs below this trunk")
    thigh_m = 0.135 * _share(base, "rump_knee_length")
    shank_m = 0.187 * _share(base, "knee_sole_length") - foot.half_height_m
    unit_m = leg_m / (thigh_m + shank_m)
    return (
        unit_m * thigh_m * m["rump_knee_length"] / base["rump_knee_length"],
        unit_m * shank_m * m["knee_sole_length"] / base["knee_sole_length"],
    )


def _radius(circumference_m: float) -> float:
    return circumference_m / (2 * math.pi)


def _share(m: Mapping[str, float], name: str) -> float:
    """Return a measurement as a multiple of the reference child's."""
    return m[name] / REFERENCE_M[name]
