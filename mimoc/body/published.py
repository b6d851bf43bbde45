"""The body of MIMo v2, which its papers' results were obtained with (López et al. 2025): sizes and places by formula.

Each is MIMo's own in proportion to one or two of 18 measurements; constants are MIMo's, in m. What is wrong with them
is part of those results and kept (`published_figures.DEFECTS`; docs/published.md). Five-finger hands, their feet and
the neck are those of MIMo's later release.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from operator import or_
from types import MappingProxyType

from mimoc.anatomy.part import BodyGeometry, GeomShape, PartKind
from mimoc.anatomy.parts.hands import FINGERS, finger_dimensions
from mimoc.anatomy.published_figures import SIZES_M
from mimoc.anatomy.sections import CLEARANCE_M
from mimoc.anatomy.segments import REFERENCE_M, foot_half_height, hand_half_thickness, radius_of, share
from mimoc.base.errors import GeometryError
from mimoc.base.geometry.rotations import Vec3
from mimoc.fits import Measurements

TINY_M = 1e-6  # Half length of the neck, a ball that nothing touches and that weighs nothing.
TIP = 0.45125  # By how much of its radius the straight part of a fingertip is shorter than half of the bone before it.


TRUNK_GEOMS: Mapping[str, tuple[float, float]] = {
    "lb": (-0.002, 0.005),
    "cb": (0.005, -0.008),
    "ub1": (0.007, -0.032),
    "ub2": (0.004, 0.030),
    "ub3": (0.0, 0.0),
}
"""Places of the trunk's geoms along x, which do not grow, and along z, in MIMo's reference body."""


def standing_height(child: Measurements) -> float:
    """Return the height of a child, from the soles to the crown, in [m]."""
    m = dict(child)
    radius_m, half_m = thigh(m)
    trunk_m = 0.298 * child.slenderness * share(m, "hip_breadth")
    head_m = 0.147 * share(m, "head_circumference")
    return trunk_m + head_m + 0.007 + 2 * radius_m + half_m + 0.176 * share(m, "knee_sole_length") + foot_half_height(m)


def published_dimensions(child: Measurements, side: str, kinds: Iterable[PartKind]) -> BodyGeometry:
    """Return the dimensions of MIMo's parts of a child's side, or middle (""), or raise a GeometryError."""
    m = child.of_side(side)
    dimensions = reduce(or_, (FORMULAS[kind.name](m) for kind in kinds if kind.name in FORMULAS))
    for name, shape in dimensions.shapes.items():
        if min(shape.size_m) <= 0:
            part = name.removeprefix("{side}_")
            raise GeometryError(f"by the law `published`, these measurements leave no room for '{part}'")
    return dimensions if child.slenderness == 1 else dimensions | _stretched(dimensions, child.slenderness)


def _stretched(dimensions: BodyGeometry, height: float) -> BodyGeometry:
    """Return the trunk's parts that much higher above each other, for a child that is more slender than the average."""
    shapes = {name: dimensions.shapes[name] for name in (*TRUNK_GEOMS, "neck")}
    return BodyGeometry(
        origins={
            name: _higher(dimensions.origins[name], height) for name in ("lower_body", "upper_body", "chest", "head")
        },
        shapes={name: GeomShape(shape.size_m, _higher(shape.pos_m, height)) for name, shape in shapes.items()},
    )


def _higher(pos_m: Vec3, factor: float) -> Vec3:
    x, y, z = pos_m
    return x, y, factor * z


def _trunk(m: Mapping[str, float]) -> BodyGeometry:
    s = share(m, "hip_breadth")
    shapes = {
        name: GeomShape(_times(SIZES_M[name], s), (x_m, 0.0, z_m * s)) for name, (x_m, z_m) in TRUNK_GEOMS.items()
    }
    radius_m = 0.018375 * share(m, "head_circumference")
    neck = GeomShape((radius_m, TINY_M), (0.0, 0.0, 0.131 * s + TINY_M))
    joints = {level: (0.0, 0.0, -shapes[geom].size_m[0]) for level, geom in ((1, "cb"), (2, "ub1"))}
    return BodyGeometry(
        origins={
            "hip": (0.0, 0.0, 0.0),
            "lower_body": (0.002, 0.0, 0.076 * s),
            "upper_body": (-0.002, 0.0, 0.091 * s),
            "chest": (0.0, 0.0, 0.090 * s),
            "head": (0.0, 0.0, 0.131 * s + 2 * TINY_M),
        },
        shapes={**shapes, "neck": neck},
        anchors={f"robot:hip_{way}{level}": at for level, at in joints.items() for way in ("lean", "rot", "bend")},
    )


def _head(m: Mapping[str, float]) -> BodyGeometry:
    s = share(m, "head_circumference")
    eye_y_m = 0.0245 * s
    return BodyGeometry(
        shapes={"head": GeomShape((0.0735 * s,), (0.01 * s, 0.0, 0.0735 * s))},
        anchors={"robot:head_tilt": (0.0, 0.0, eye_y_m / 2), "robot:head_tilt_side": (0.0, 0.0, eye_y_m)},
    )


def _eyes(m: Mapping[str, float]) -> BodyGeometry:
    s = share(m, "head_circumference")
    return BodyGeometry(
        origins={"{side}_eye": (0.07 * s, -0.0245 * s, 0.067375 * s)},
        shapes={"{side}_eye1": GeomShape((0.01125 * s,), (0.0, 0.0, 0.0))},
    )


def _limb(m: Mapping[str, float], geom: str, girth: str, whole: str, less: str = "") -> tuple[float, float]:
    """Return radius and half length of a limb as long as *whole* less the measurement *less* and both radii."""
    radius_m, half_m = SIZES_M[geom]

    def straight_m(of: Mapping[str, float]) -> float:
        return (of[whole] - (of[less] if less else 0.0)) / 2 - radius_of(of[girth])

    return radius_m * share(m, girth), half_m * straight_m(m) / straight_m(REFERENCE_M)


def _arm(m: Mapping[str, float]) -> BodyGeometry:
    radius_m, half_m = _limb(m, "{side}_uarm1", "upper_arm_circumference", "shoulder_elbow_length")
    fore_m, fore_half_m = _forearm(m)
    return BodyGeometry(
        origins={
            "{side}_upper_arm": (0.0, -0.088 * share(m, "hip_breadth") - radius_m / 4, 0.0),
            "{side}_lower_arm": (0.0, 0.0, 2 * half_m),
        },
        shapes={
            "{side}_uarm1": GeomShape((radius_m, half_m), (0.0, 0.0, half_m)),
            "{side}_larm": GeomShape((fore_m, fore_half_m), (0.0, 0.0, fore_half_m)),
        },
    )


def _forearm(m: Mapping[str, float]) -> tuple[float, float]:
    return _limb(m, "{side}_larm", "forearm_circumference", "elbow_hand_length", less="hand_length")


def _mitten(m: Mapping[str, float]) -> BodyGeometry:
    fore_m, fore_half_m = _forearm(m)
    long = share(m, "hand_length")
    fist = share(m, "maximum_fist_breadth")
    half_m = m["hand_breadth"] / 2
    thick_m = hand_half_thickness(m)
    rim_m, palm_m = thick_m + 2 * CLEARANCE_M, 0.0208 * long
    fingers_m, thumb_m = 0.0207 * long, thick_m / 2
    return BodyGeometry(
        origins={
            "{side}_hand": (0.0, 0.0, 0.087 / 0.097 * (fore_m + 2 * fore_half_m)),
            "{side}_fingers": (0.0, 0.0, 2 * palm_m),
        },
        shapes={
            "{side}_hand1": GeomShape((0.0281 * fist, thick_m, palm_m), (thumb_m, 0.0, palm_m)),
            "{side}_hand2": GeomShape((rim_m, 0.0281 * fist), (thumb_m, 0.0, 2 * palm_m)),
            "{side}_fingers1": GeomShape((half_m - 2 * CLEARANCE_M, thick_m, fingers_m), (0.0, 0.0, fingers_m)),
            "{side}_fingers2": GeomShape((rim_m, half_m), (0.0, 0.0, 2 * fingers_m)),
        },
    )


def _five_fingers(m: Mapping[str, float]) -> BodyGeometry:
    thick_m = 0.584 * hand_half_thickness(m)
    wide = share(m, "hand_breadth")
    palm_m = m["hand_length"] / 4 - thick_m
    half_m = m["hand_length"] / 8
    middle_m = m["middle_finger_diameter"] / 2
    knuckle_x_m = 0.01712 * wide - CLEARANCE_M - 0.95 * middle_m
    little_x_m = -(0.01712 + 0.00588**2 / 0.00508 - 0.01498) * wide  # On its metacarpal.
    little_z_m = palm_m / 2 - 0.0031 * wide
    roots: dict[str, Vec3] = {
        "ff": (knuckle_x_m, 0.0, palm_m),
        "mf": (0.0, 0.0, palm_m),
        "rf": (-knuckle_x_m, 0.0, palm_m),
        "lf": (little_x_m, 0.0, little_z_m),
    }
    dimensions = _palm(m, palm_m, thick_m)
    for name, root in roots.items():
        girth, length = FINGERS[name]
        dimensions |= finger_dimensions(name, root, girth * middle_m, length * half_m, TIP)
    return dimensions | _thumb(m)


def _palm(m: Mapping[str, float], palm_m: float, thick_m: float) -> BodyGeometry:
    fore_m, fore_half_m = _forearm(m)
    wide, half_m = share(m, "hand_breadth"), m["hand_breadth"] / 2
    side_m = 0.00588 * wide
    outer_m = 0.00508 * wide
    inner_m = 0.01712 * wide
    rim_m = thick_m + CLEARANCE_M
    hand_x_m, meta_x_m = 0.007 * wide, -0.00882 * wide - CLEARANCE_M
    anchors = {k: (-hand_x_m, 0.0, -share * palm_m) for k, share in ((1, 3 / 5), (2, 4 / 5), (3, 1.0))}
    return BodyGeometry(
        origins={
            "{side}_hand": (hand_x_m, 0.0, 0.11032 / (0.023 + 0.037) * (fore_m + fore_half_m)),
            "{side}_lfmetacarpal": (-0.01498 * wide, 0.0, 0.0031 * wide),
        },
        shapes={
            "{side}_hand1": GeomShape((inner_m, thick_m, palm_m), (0.0, 0.0, 0.0)),
            "{side}_hand2": GeomShape((side_m, thick_m, palm_m / 2), (-half_m, 0.0, -palm_m / 2)),
            "{side}_hand3": GeomShape((thick_m, inner_m - CLEARANCE_M), (0.0, 0.0, palm_m)),
            "{side}_hand4": GeomShape((thick_m, half_m - CLEARANCE_M), (-side_m, 0.0, -palm_m)),
            "{side}_lfmetacarpal1": GeomShape((outer_m, rim_m, palm_m / 2), (meta_x_m, 0.0, -0.0031 * wide)),
            "{side}_lfmetacarpal2": GeomShape(
                (rim_m, outer_m - CLEARANCE_M), (meta_x_m, 0.0, palm_m / 2 - 0.0031 * wide)
            ),
        },
        anchors={f"robot:{{side}}_hand{k}": anchor_m for k, anchor_m in anchors.items()},
    )


def _thumb(m: Mapping[str, float]) -> BodyGeometry:
    whole_m, radius_m = m["hand_length"] / 8, m["thumb_diameter"] / 2
    bones = {"base": (radius_m, 0.75), "hub": (0.95 * radius_m, 0.525), "distal": (0.9025 * radius_m, 0.4875)}
    root = 0.0123 * share(m, "hand_breadth"), -0.423 * hand_half_thickness(m), -0.01602 * share(m, "hand_length")
    return BodyGeometry(
        origins={
            "{side}_thbase": root,
            "{side}_thhub": (0.0, 0.0, 1.5 * whole_m),
            "{side}_thdistal": (0.0, 0.0, 1.05 * whole_m),
        },
        shapes={
            f"{{side}}_th{bone}1": GeomShape((thick_m, share * whole_m), (0.0, 0.0, share * whole_m))
            for bone, (thick_m, share) in bones.items()
        },
    )


def thigh(m: Mapping[str, float]) -> tuple[float, float]:
    """Return radius and half length of a thigh, in [m]."""
    return _limb(m, "{side}_upper_leg1", "mid_thigh_circumference", "rump_knee_length")


def _leg(m: Mapping[str, float]) -> BodyGeometry:
    radius_m, half_m = thigh(m)
    calf_m, ankle_m = (radius_of(m[f"{part}_circumference"]) for part in ("calf", "ankle"))
    s = share(m, "knee_sole_length")
    return BodyGeometry(
        origins={
            "{side}_upper_leg": (0.005, -0.051 * share(m, "hip_breadth"), -0.007),
            "{side}_lower_leg": (0.0, 0.0, -2 * radius_m - half_m),
            "{side}_foot": (0.0, 0.0, -0.176 * s),
        },
        shapes={
            "{side}_upper_leg1": GeomShape((radius_m, half_m), (0.0, 0.0, -1.032 * half_m)),
            "{side}_lower_leg1": GeomShape((calf_m, 0.044 * s), (0.0, 0.0, -0.044 * s)),
            "{side}_lower_leg2": GeomShape((ankle_m, 0.028 * s), (0.0, 0.0, -0.132 * s)),
        },
    )


def _foot(m: Mapping[str, float]) -> BodyGeometry:
    s = share(m, "foot_length")
    half_m = m["foot_breadth"] / 2
    height_m = foot_half_height(m)
    return BodyGeometry(
        shapes={
            "{side}_foot1": GeomShape((half_m - CLEARANCE_M, height_m - CLEARANCE_M), (-0.016 * s, 0.0, 0.0)),
            "{side}_foot2": GeomShape((0.035 * s, half_m, height_m), (0.019 * s, 0.0, 0.0)),
            "{side}_foot3": GeomShape((height_m - CLEARANCE_M, half_m - 2 * CLEARANCE_M), (0.054 * s, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": (0.0, 0.0, 1.5 * height_m) for k in (1, 2, 3)},
    )


def _toes(name: str, m: Mapping[str, float], half_m: float, widths_m: tuple[float, float], y_m: float) -> BodyGeometry:
    s, height_m = share(m, "foot_length"), foot_half_height(m)
    box_m, tip_m = widths_m
    return BodyGeometry(
        origins={f"{{side}}_{name}": (0.054 * s, y_m, 0.0)},
        shapes={
            f"{{side}}_{name}1": GeomShape((half_m * s, box_m, height_m - CLEARANCE_M), (half_m * s, 0.0, 0.0)),
            f"{{side}}_{name}2": GeomShape((height_m, tip_m), (2 * half_m * s, 0.0, 0.0)),
        },
    )


def _flat_foot(m: Mapping[str, float]) -> BodyGeometry:
    half_m = m["foot_breadth"] / 2
    return _foot(m) | _toes("toes", m, 0.007, (half_m - CLEARANCE_M, half_m), 0.0)


def _two_toed_foot(m: Mapping[str, float]) -> BodyGeometry:
    wide = share(m, "foot_breadth")
    big = _toes("big_toe", m, 0.0095, (0.007 * wide, 0.0075 * wide), 0.0175 * wide)
    return _foot(m) | big | _toes("toes", m, 0.0095, (0.016 * wide, 0.0165 * wide), -0.0075 * wide)


def _times(size_m: tuple[float, ...], factor: float) -> tuple[float, ...]:
    return tuple(factor * part_m for part_m in size_m)


FORMULAS: Mapping[str, Callable[[Mapping[str, float]], BodyGeometry]] = MappingProxyType(
    {
        "trunk": _trunk,
        "head": _head,
        "eyes": _eyes,
        "arm": _arm,
        "mitten": _mitten,
        "five_finger": _five_fingers,
        "leg": _leg,
        "flat_foot": _flat_foot,
        "two_toed_foot": _two_toed_foot,
    }
)
"""By kind of parts, what returns its dimensions from the measurements of a child, in [m]."""
