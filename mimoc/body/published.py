"""The shapes whose volumes strength follows by the published law, and masses as well.

They are those of MIMo v2 with its growth corrected: trunks are as deep as girths are in proportion to MIMo's, and the
shoulder joints are as far apart as shoulders are broad. Bodies have other shapes (`trunk`), such that they have the
measured girths, breadths and lengths; strength stays what it was.
"""

from collections.abc import Mapping

from mimoc.body.sections import CLEARANCE_M, NO_ROOM, Trunk, axial_spacing
from mimoc.errors import GeometryError

REFERENCE_M: Mapping[str, float] = {
    "chest_circumference": 0.468,
    "elbow_hand_length": 0.207,
    "hand_length": 0.093,
    "hip_breadth": 0.171,
    "hip_circumference": 0.477,
    "knee_sole_length": 0.216,
    "rump_knee_length": 0.213,
    "shoulder_elbow_length": 0.154,
    "waist_circumference": 0.431,
}
"""Of the reference child, about 18 months old (AnthroKids, 16-19 completed months)."""


def published_trunk(m: Mapping[str, float], head_radius_m: float, arm_radius_m: float) -> Trunk:
    """Return the published trunk: widths from breadths, depths from girths, height from crown-rump length and head.

    Raises:
        GeometryError: If a measurement does not fit the others.
    """
    pelvis_radius_m = 0.048 * _share(m, "hip_circumference")
    belly_scale = _share(m, "chest_circumference")
    shoulder_y_m = m["shoulder_breadth"] / 2
    axial = axial_spacing(m["crown_rump_length"], head_radius_m, pelvis_radius_m)
    belly_radius_m = min(0.052 * belly_scale, 0.129 * axial - pelvis_radius_m)
    if belly_radius_m <= 0.013 * belly_scale:
        raise GeometryError(NO_ROOM)
    return Trunk(
        axial=axial,
        pelvis=(pelvis_radius_m, m["hip_breadth"] / 2),
        waist=(0.053 * _share(m, "waist_circumference"), (m["hip_breadth"] + m["chest_breadth"]) / 4),
        belly=(belly_radius_m, m["chest_breadth"] / 2),
        ribs=(0.048 * belly_scale, m["chest_breadth"] / 2),
        girdle=(0.041 * belly_scale, shoulder_y_m - arm_radius_m - CLEARANCE_M),
        shoulder_y_m=shoulder_y_m,
        arm_inwards_m=0.0,
        hip_y_m=0.051 * _share(m, "hip_breadth"),
        rump_m=pelvis_radius_m - 0.012 * axial,
        buttocks_m=pelvis_radius_m,
    )


def published_arm(m: Mapping[str, float]) -> tuple[float, float]:
    """Return the published lengths of upper arm and forearm, in the reference body's proportion to measured ones."""
    to_wrist_m, reference_m = (each["elbow_hand_length"] - each["hand_length"] for each in (m, REFERENCE_M))
    return 0.1076 * _share(m, "shoulder_elbow_length"), 0.087 * to_wrist_m / reference_m


def published_leg(
    m: Mapping[str, float], base: Mapping[str, float], leg_m: float, foot_height_m: float
) -> tuple[float, float]:
    """Return the published lengths of thigh and shank.

    They are in proportion to rump-knee and knee-sole length, as in the reference body; if one of these was replaced,
    its segment changes in the same proportion.

    Args:
        m: Measurements in [m], by AnthroKids name.
        base: The same before any of them was replaced.
        leg_m: Length of both, in [m].
        foot_height_m: Half the height of the foot.
    """
    thigh_m = 0.135 * _share(base, "rump_knee_length")
    shank_m = 0.187 * _share(base, "knee_sole_length") - foot_height_m
    unit_m = leg_m / (thigh_m + shank_m)
    return (
        unit_m * thigh_m * m["rump_knee_length"] / base["rump_knee_length"],
        unit_m * shank_m * m["knee_sole_length"] / base["knee_sole_length"],
    )


def _share(m: Mapping[str, float], name: str) -> float:
    """Return a measurement as a multiple of the reference child's."""
    return m[name] / REFERENCE_M[name]
