"""Shapes and joint positions of trunk, head and limbs, from an infant's proportions.

All values are for the right side, in MIMo's frames: x forward, y left, z up on trunk and legs; along the limb on the
arms. Numbers are those of the reference body, in [m].
"""

from collections.abc import Callable, Mapping
from functools import reduce
from operator import or_

from mimoc.body.dimensions import Dimensions, Shape
from mimoc.body.extremities import fingers_dimensions, flat_foot_dimensions, mitten_dimensions, toes_dimensions
from mimoc.body.proportions import Limb, Proportions
from mimoc.body.trunk import GIRDLE_BACK, SHOULDER_BACK, Section, Trunk
from mimoc.errors import GeometryError
from mimoc.geometry.rotations import Vec3

REFERENCE_HEAD_RADIUS_M = 0.0735
REFERENCE_PELVIS_RADIUS_M = 0.059
PELVIS_X_M, CHEST_X_M = 0.008, 0.004
"""How far pelvis and chest are in front of the hip's origin in the reference body, so that backs are in line (D)."""
PELVIS_Z_M = 0.005

ShapeRule = Callable[[Proportions], Dimensions]
"""From proportions to the dimensions of some parts."""


def body_dimensions(p: Proportions, hands: str) -> Dimensions:
    """Return the dimensions of a whole body with `mitten` or `five_finger` hands.

    Raises:
        GeometryError: If a segment is wider than it is long.
    """
    return reduce(or_, (shape(p) for shape in (*SHAPES, HANDS[hands], FEET[hands])))


def _trunk_dimensions(p: Proportions) -> Dimensions:
    t, z = p.trunk, p.trunk.axial
    depth = t.pelvis[0] / REFERENCE_PELVIS_RADIUS_M
    neck = p.head_radius_m / REFERENCE_HEAD_RADIUS_M
    bend = {
        f"robot:hip_{motion}{level}": (0.0, 0.0, -0.05 * z) for motion in ("lean", "rot", "bend") for level in (1, 2)
    }
    return Dimensions(
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
            "neck": Shape((0.028 * neck, 0.02 * z), (-0.004 * neck, 0.0, 0.125 * z)),
            "ub3": _across(t.girdle, _behind_chest(t, GIRDLE_BACK), 0.0),
        },
        anchors=bend,
    )


def _head_dimensions(p: Proportions) -> Dimensions:
    radius_m = p.head_radius_m
    s = radius_m / REFERENCE_HEAD_RADIUS_M
    return Dimensions(
        origins={"head": (0.0, 0.0, 0.135 * p.trunk.axial), "{side}_eye": (0.07 * s, -0.0245 * s, 0.067375 * s)},
        shapes={
            "head": Shape((radius_m,), (0.01 * s, 0.0, radius_m)),
            "{side}_eye1": Shape((0.01125 * s,), (0.0, 0.0, 0.0)),
        },
        anchors={"robot:head_tilt": (0.0, 0.0, 0.0123 * s), "robot:head_tilt_side": (0.0, 0.0, 0.0245 * s)},
    )


def _arm_dimensions(p: Proportions) -> Dimensions:
    axis_y_m = -p.trunk.arm_inwards_m  # The arm hangs: its y points to the midline.
    return Dimensions(
        origins={
            "{side}_upper_arm": (_behind_chest(p.trunk, SHOULDER_BACK), -p.trunk.shoulder_y_m, 0.003 * p.trunk.axial),
            "{side}_lower_arm": (0.0, 0.0, p.upper_arm.length_m),
        },
        shapes={
            "{side}_uarm1": _moved(_along("upper arm", p.upper_arm, p.forearm.radius_m), axis_y_m),
            "{side}_larm": _along("forearm", p.forearm, p.hand.half_thickness_m),
        },
        anchors={"robot:{side}_shoulder_horizontal": (0.0, -p.upper_arm.radius_m, 0.0)},
    )


def _leg_dimensions(p: Proportions) -> Dimensions:
    thigh, shank = p.thigh, p.shank
    into_foot_m = shank.length_m + 0.6 * p.foot.half_height_m
    lower_start_m, lower_end_m = 0.6 * shank.length_m, into_foot_m - p.ankle_radius_m
    if lower_end_m <= lower_start_m:
        raise GeometryError(
            f"a shank {shank.length_m:.3f} m long cannot have an ankle {2 * p.ankle_radius_m:.3f} m thick"
        )
    return Dimensions(
        origins={
            "{side}_upper_leg": _hip_joint(p.trunk),
            "{side}_lower_leg": (p.knee_forward_m, 0.0, -thigh.length_m),
            "{side}_foot": (0.0, 0.0, -shank.length_m),
        },
        shapes={
            "{side}_upper_leg1": _flip(_along("thigh", thigh, shank.radius_m)),
            "{side}_lower_leg1": Shape(
                (shank.radius_m, 0.044 / 0.177 * shank.length_m), (0.0, 0.0, -0.044 / 0.177 * shank.length_m)
            ),
            "{side}_lower_leg2": Shape(
                (p.ankle_radius_m, (lower_end_m - lower_start_m) / 2), (0.0, 0.0, -(lower_start_m + lower_end_m) / 2)
            ),
        },
    )


def _behind_chest(t: Trunk, radii: float) -> float:
    """Return the x of what is some radii of the chest behind its middle, in the frame of the chest."""
    return CHEST_X_M * t.pelvis[0] / REFERENCE_PELVIS_RADIUS_M - radii * t.ribs[0]


def _hip_joint(t: Trunk) -> Vec3:
    """Return the place of the right hip joint, behind and below the middle of the pelvis."""
    radius_m = t.pelvis[0]
    x_m = PELVIS_X_M * radius_m / REFERENCE_PELVIS_RADIUS_M - (radius_m - t.buttocks_m)
    return x_m, -t.hip_y_m, PELVIS_Z_M * t.axial - (radius_m - t.rump_m)


def _moved(solid: Shape, y_m: float) -> Shape:
    """Return a solid moved along y."""
    x_m, _, z_m = solid.pos_m
    return Shape(solid.size_m, (x_m, y_m, z_m))


def _across(section: Section, x_m: float, z_m: float) -> Shape:
    """Return a capsule along y from its radius and half width."""
    radius_m, half_width_m = section
    if half_width_m <= radius_m:
        raise GeometryError(f"a trunk {2 * half_width_m:.3f} m wide cannot be {2 * radius_m:.3f} m deep")
    return Shape((radius_m, half_width_m - radius_m), (x_m, 0.0, z_m))


def _along(what: str, limb: Limb, embed_m: float) -> Shape:
    """Return a capsule along +z, whose axis starts at its joint and which ends *embed_m* beyond the next one."""
    axis_m = limb.length_m + embed_m - limb.radius_m
    if axis_m <= 0:
        raise GeometryError(f"{what}: a limb {limb.length_m:.3f} m long cannot be {2 * limb.radius_m:.3f} m thick")
    return Shape((limb.radius_m, axis_m / 2), (0.0, 0.0, axis_m / 2))


def _flip(solid: Shape) -> Shape:
    """Return the same solid along -z instead of +z."""
    x_m, y_m, z_m = solid.pos_m
    return Shape(solid.size_m, (x_m, y_m, -z_m))


SHAPES: tuple[ShapeRule, ...] = (_trunk_dimensions, _head_dimensions, _arm_dimensions, _leg_dimensions)
"""The shapes of all parts but those of hands and feet."""
HANDS: Mapping[str, ShapeRule] = {"mitten": mitten_dimensions, "five_finger": fingers_dimensions}
FEET: Mapping[str, ShapeRule] = {"mitten": flat_foot_dimensions, "five_finger": toes_dimensions}
"""The shapes of hands and feet, by kind of hands."""
