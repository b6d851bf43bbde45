"""Shapes and joint positions of hands and feet, from an infant's proportions; right side, in MIMo's frames."""

from mimoc.body.dimensions import Dimensions, Shape
from mimoc.body.proportions import (
    FINGER_ROOM,
    REFERENCE_M,
    THUMB_ROOM,
    Hand,
    Limb,
    Proportions,
)
from mimoc.body.trunk import CLEARANCE_M
from mimoc.errors import GeometryError
from mimoc.geometry.rotations import Vec3

FINGERS = {"ff": (0.95, 0.9), "mf": (1.0, 1.0), "rf": (0.95, 0.9), "lf": (0.91, 0.88)}
"""Radius and length of each finger relative to the middle finger (MIMo v2)."""


def mitten_dimensions(p: Proportions) -> Dimensions:
    """Return palm and fingers, whose tip, at the length of the hand, is rounded with half the hand's thickness."""
    h = p.hand
    tip_m = h.half_thickness_m + 2 * CLEARANCE_M
    palm_m = (h.length_m - tip_m) * 0.0416 / 0.083
    fingers_m = h.length_m - tip_m - palm_m
    _check_hand(h, max(h.half_breadth_m, h.half_fist_m))
    if h.length_m <= 4 * tip_m:
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot be {2 * h.half_thickness_m:.3f} m thick")
    thumb_m = 0.5 * h.half_thickness_m
    rim_m = h.half_fist_m - 2 * CLEARANCE_M
    return Dimensions(
        origins={
            "{side}_hand": (0.0, -0.7 * h.half_thickness_m, p.forearm.length_m),
            "{side}_fingers": (0.0, 0.0, palm_m),
        },
        shapes={
            "{side}_hand1": Shape((h.half_fist_m, h.half_thickness_m, palm_m / 2), (thumb_m, 0.0, palm_m / 2)),
            "{side}_hand2": Shape((tip_m, rim_m), (thumb_m, 0.0, palm_m)),
            "{side}_fingers1": Shape(
                (h.half_breadth_m - 2 * CLEARANCE_M, h.half_thickness_m, fingers_m / 2), (0.0, 0.0, fingers_m / 2)
            ),
            "{side}_fingers2": Shape((tip_m, h.half_breadth_m), (0.0, 0.0, fingers_m)),
        },
        anchors={"robot:{side}_hand1": (0.0, 0.7 * h.half_thickness_m, 0.0)},
    )


def _check_hand(h: Hand, half_width_m: float) -> None:
    if h.length_m <= 2 * half_width_m:
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot be {2 * half_width_m:.3f} m wide")


def flat_foot_dimensions(p: Proportions) -> Dimensions:
    """Return heel, sole and toes, distributed along x so that the foot has its measured length."""
    f = p.foot
    heel_m, toe_m = f.half_breadth_m - CLEARANCE_M, f.half_height_m
    s = (f.length_m - heel_m - toe_m) / 0.084
    if f.length_m <= 2 * f.half_breadth_m:
        raise GeometryError(f"a foot {f.length_m:.3f} m long cannot be {2 * f.half_breadth_m:.3f} m wide")
    half_width_m, half_height_m = f.half_breadth_m, f.half_height_m
    ankle = (0.0, 0.0, 1.5 * half_height_m)
    return Dimensions(
        origins={"{side}_toes": (0.054 * s, 0.0, 0.0)},
        shapes={
            "{side}_foot1": Shape((heel_m, half_height_m - CLEARANCE_M), (-0.016 * s, 0.0, 0.0)),
            "{side}_foot2": Shape((0.035 * s, half_width_m, half_height_m), (0.019 * s, 0.0, 0.0)),
            "{side}_foot3": Shape((half_height_m - CLEARANCE_M, half_width_m - 2 * CLEARANCE_M), (0.054 * s, 0.0, 0.0)),
            "{side}_toes1": Shape(
                (0.007 * s, half_width_m - CLEARANCE_M, half_height_m - CLEARANCE_M), (0.007 * s, 0.0, 0.0)
            ),
            "{side}_toes2": Shape((toe_m, half_width_m), (0.014 * s, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": ankle for k in (1, 2, 3)},
    )


def fingers_dimensions(p: Proportions) -> Dimensions:
    """Return a five-finger hand, whose palm and middle finger are each half as long as the hand."""
    h = p.hand
    thick_m = 0.584 * h.half_thickness_m
    palm_m = h.length_m / 4 - thick_m
    wide = h.half_breadth_m / (REFERENCE_M["hand_breadth"] / 2)
    _check_hand(h, h.half_breadth_m)
    if h.finger_radius_m > FINGER_ROOM * h.length_m or h.thumb_radius_m > THUMB_ROOM * h.length_m:
        thickest_m = 2 * max(h.finger_radius_m, h.thumb_radius_m)
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot have fingers {thickest_m:.4f} m thick")
    if palm_m <= 0:
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot be {2 * thick_m:.3f} m thick")
    dimensions = _palm_dimensions(h, p.forearm, palm_m, thick_m, wide)
    knuckles_m = palm_m + thick_m
    roots = {
        "ff": (0.01177 * wide, 0.0, palm_m + 0.7 * thick_m),
        "mf": (0.0, 0.0, knuckles_m),
        "rf": (-0.01177 * wide, 0.0, palm_m + 0.7 * thick_m),
        "lf": (-0.00849 * wide, 0.0, 0.204 * palm_m + palm_m / 2 + 0.8 * thick_m),
    }
    for name, root in roots.items():
        girth, length = FINGERS[name]
        dimensions |= _finger_dimensions(name, root, girth * h.finger_radius_m, length * h.length_m / 8)
    return dimensions | _thumb_dimensions(h, palm_m, wide)


def _palm_dimensions(h: Hand, forearm: Limb, palm_m: float, thick_m: float, wide: float) -> Dimensions:
    middle_m = (0.0, 0.0, 0.0)
    side_x_m = 0.007 * wide
    meta_m = 0.204 * palm_m
    return Dimensions(
        origins={
            "{side}_hand": (side_x_m, -0.9 * h.half_thickness_m, forearm.length_m + palm_m + thick_m),
            "{side}_lfmetacarpal": (-0.01498 * wide, 0.0, 0.122 * palm_m),
        },
        shapes={
            "{side}_hand1": Shape((0.01712 * wide, thick_m, palm_m), middle_m),
            "{side}_hand2": Shape((0.00588 * wide, thick_m, palm_m / 2), (-h.half_breadth_m, 0.0, -palm_m / 2)),
            "{side}_hand3": Shape((thick_m, 0.01712 * wide - CLEARANCE_M), (0.0, 0.0, palm_m)),
            "{side}_hand4": Shape((thick_m, h.half_breadth_m), (-0.00588 * wide, 0.0, -palm_m)),
            "{side}_lfmetacarpal1": Shape((0.00508 * wide, thick_m, palm_m / 2), (-0.00883 * wide, 0.0, meta_m)),
            "{side}_lfmetacarpal2": Shape(
                (thick_m, 0.00508 * wide - CLEARANCE_M), (-0.00883 * wide, 0.0, meta_m + palm_m / 2)
            ),
        },
        anchors={
            "robot:{side}_hand1": (-side_x_m, 0.9 * thick_m, -0.68 * palm_m - thick_m),
            "robot:{side}_hand2": (-side_x_m, -0.6 * thick_m, -0.84 * palm_m - thick_m),
            "robot:{side}_hand3": (-side_x_m, 0.0, -palm_m - thick_m),
        },
    )


def _finger_dimensions(name: str, root: Vec3, radius_m: float, half_m: float) -> Dimensions:
    """Return three phalanges, the first twice as long, from joint to joint, as each of the others."""
    tip_m = half_m / 2 - 0.45 * radius_m
    return Dimensions(
        origins={
            f"{{side}}_{name}knuckle": root,
            f"{{side}}_{name}middle": (0.0, 0.0, 2 * half_m),
            f"{{side}}_{name}distal": (0.0, 0.0, half_m),
        },
        shapes={
            f"{{side}}_{name}knuckle1": Shape((radius_m, half_m), (0.0, 0.0, half_m)),
            f"{{side}}_{name}middle1": Shape((0.95 * radius_m, half_m / 2), (0.0, 0.0, half_m / 2)),
            f"{{side}}_{name}distal1": Shape((0.9025 * radius_m, tip_m), (0.0, 0.0, tip_m)),
        },
    )


def _thumb_dimensions(h: Hand, palm_m: float, wide: float) -> Dimensions:
    half_m, radius_m = 0.75 * h.length_m / 8, h.thumb_radius_m
    lengths_m = (half_m, 0.75 * half_m, 0.6 * half_m)
    base_m, hub_m, tip_m = lengths_m
    return Dimensions(
        origins={
            "{side}_thbase": (0.0123 * wide, -0.423 * h.half_thickness_m, -0.633 * palm_m),
            "{side}_thhub": (0.0, 0.0, 2 * base_m),
            "{side}_thdistal": (0.0, 0.0, 2 * hub_m),
        },
        shapes={
            "{side}_thbase1": Shape((radius_m, base_m), (0.0, 0.0, base_m)),
            "{side}_thhub1": Shape((0.95 * radius_m, hub_m), (0.0, 0.0, hub_m)),
            "{side}_thdistal1": Shape((0.9025 * radius_m, tip_m), (0.0, 0.0, tip_m)),
        },
    )


def toes_dimensions(p: Proportions) -> Dimensions:
    """Return a foot with a separate big toe, distributed along x so that the foot has its measured length."""
    f = p.foot
    heel_m, height_m, half_m = f.half_breadth_m - CLEARANCE_M, f.half_height_m, f.half_breadth_m
    s = (f.length_m - heel_m - height_m) / 0.079
    if f.length_m <= 2 * f.half_breadth_m:
        raise GeometryError(f"a foot {f.length_m:.3f} m long cannot be {2 * f.half_breadth_m:.3f} m wide")
    wide = half_m / (REFERENCE_M["foot_breadth"] / 2)
    dimensions = Dimensions(
        origins={"{side}_big_toe": (0.053 * s, 0.0175 * wide, 0.0), "{side}_toes": (0.053 * s, -0.0075 * wide, 0.0)},
        shapes={
            "{side}_foot1": Shape((heel_m, height_m - CLEARANCE_M), (-0.007 * s, 0.0, 0.0)),
            "{side}_foot2": Shape((0.030 * s, half_m, height_m), (0.023 * s, 0.0, 0.0)),
            "{side}_foot3": Shape((height_m - CLEARANCE_M, half_m - 2 * CLEARANCE_M), (0.053 * s, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": (0.0, 0.0, 1.5 * height_m) for k in (1, 2, 3)},
    )
    for name, half_width_m in {"big_toe": 0.0075 * wide, "toes": 0.0165 * wide}.items():
        box_m = (0.0095 * s, half_width_m - CLEARANCE_M, height_m - CLEARANCE_M)
        dimensions |= Dimensions(
            shapes={
                f"{{side}}_{name}1": Shape(box_m, (0.0095 * s, 0.0, 0.0)),
                f"{{side}}_{name}2": Shape((height_m, half_width_m), (0.019 * s, 0.0, 0.0)),
            }
        )
    return dimensions
