"""Hands whose fingers move together (mittens) or independently, of MIMo's second body: parts and their shapes.

Names with `{side}` stand for a right and a left part; values are those of the right side. Fingers are
ff, mf, rf and lf (first, middle, ring, little) and th (thumb), as in MIMo (Mattern et al. 2024).
"""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.anatomy.part import (
    ALONG_X,
    UPRIGHT,
    WRIST,
    BodyGeometry,
    GeomShape,
    GeomType,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
)
from mimoc.anatomy.parts.limbs import WRIST_JOINTS, WRIST_MOTORS
from mimoc.anatomy.sections import CLEARANCE_M
from mimoc.anatomy.segments import FINGER_ROOM, REFERENCE_M, THUMB_ROOM, Hand, Limb, Proportions
from mimoc.base.errors import GeometryError
from mimoc.base.geometry.rotations import Vec3

_MITTEN_PALM = ("maximum_fist_breadth", "hand_length", "hand_breadth")
_MITTEN_FINGERS = ("hand_breadth", "hand_length")
_HAND_GRIP = (5.0, 0.02, 0.01)

MITTEN_PARTS = (
    ReferencePart(
        "{side}_hand",
        "{side}_lower_arm",
        (
            ReferenceGeom(
                "{side}_hand1",
                "box",
                0.04315,
                _MITTEN_PALM,
                "as wide as maximum_fist_breadth, half of hand_length less the fingertip's radius",
            ),
            ReferenceGeom(
                "{side}_hand2", "cylinder", 0.01602, _MITTEN_PALM, "rounds the palm off at the knuckles", ALONG_X
            ),
        ),
        WRIST_JOINTS,
        position_from=WRIST,
        rule="elbow_hand_length less hand_length and the flesh behind the elbow, which is as thick as the arm",
        motors=WRIST_MOTORS,
        group="{side}_hand",
        skin_spacing_m=0.007,
        torque_site="torque_{side}_wrist",
    ),
    ReferencePart(
        "{side}_fingers",
        "{side}_hand",
        (
            ReferenceGeom(
                "{side}_fingers1",
                "box",
                0.03494,
                _MITTEN_FINGERS,
                "as wide as hand_breadth, half of hand_length less the fingertip's radius",
                friction=_HAND_GRIP,
            ),
            ReferenceGeom(
                "{side}_fingers2",
                "cylinder",
                0.01323,
                _MITTEN_FINGERS,
                "rounds the fingertips off at hand_length from the wrist",
                ALONG_X,
                _HAND_GRIP,
            ),
        ),
        (ReferenceJoint("robot:{side}_fingers", (-1, 0, 0), (-160, 8), 0.017, 0.018, 0.0023, 0.0001, -40),),
        position_from=("hand_length", "hand_breadth"),
        rule="at the knuckles, half of hand_length less the fingertip's radius",
        motors=(ReferenceMotor("act:{side}_fingers", "robot:{side}_fingers", 0.69, (-1, 0.33), 3.019, "{side}_hand1"),),
        skin_spacing_m=0.002,
        torque_site="torque_{side}_fingers",
    ),
)


def mitten_dimensions(p: Proportions) -> BodyGeometry:
    """Return palm and fingers, whose tip, at the length of the hand, is rounded with half the hand's thickness."""
    h = p.hand
    tip_m = h.half_thickness_m + 2 * CLEARANCE_M
    palm_m = (h.length_m - tip_m) * 0.0416 / 0.083
    fingers_m = h.length_m - tip_m - palm_m
    check_hand(h, max(h.half_breadth_m, h.half_fist_m))
    if h.length_m <= 4 * tip_m:
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot be {2 * h.half_thickness_m:.3f} m thick")
    thumb_m = 0.5 * h.half_thickness_m
    rim_m = h.half_fist_m - 2 * CLEARANCE_M
    return BodyGeometry(
        origins={
            "{side}_hand": (0.0, -0.7 * h.half_thickness_m, p.forearm.length_m),
            "{side}_fingers": (0.0, 0.0, palm_m),
        },
        shapes={
            "{side}_hand1": GeomShape((h.half_fist_m, h.half_thickness_m, palm_m / 2), (thumb_m, 0.0, palm_m / 2)),
            "{side}_hand2": GeomShape((tip_m, rim_m), (thumb_m, 0.0, palm_m)),
            "{side}_fingers1": GeomShape(
                (h.half_breadth_m - 2 * CLEARANCE_M, h.half_thickness_m, fingers_m / 2), (0.0, 0.0, fingers_m / 2)
            ),
            "{side}_fingers2": GeomShape((tip_m, h.half_breadth_m), (0.0, 0.0, fingers_m)),
        },
        anchors={"robot:{side}_hand1": (0.0, 0.7 * h.half_thickness_m, 0.0)},
    )


def check_hand(h: Hand, half_width_m: float) -> None:
    """Raise a GeometryError if a hand is wider than it is long."""
    if h.length_m <= 2 * half_width_m:
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot be {2 * half_width_m:.3f} m wide")


MITTEN = PartKind("mitten", "Hands whose fingers move together.", MITTEN_PARTS, mitten_dimensions, replaces="hands")


Figures = tuple[float, ...]
Joints = tuple[ReferenceJoint, ...]
Motors = tuple[ReferenceMotor, ...]

_SIZES_M: Mapping[str, tuple[Figures, ...]] = {
    "hand": ((0.01712, 0.00584, 0.02532), (0.00588, 0.00584, 0.01292), (0.00584, 0.0171), (0.00584, 0.02298)),
    "ff": ((0.00549, 0.00992), (0.0052, 0.00501), (0.005, 0.00464)),
    "mf": ((0.00579, 0.011), (0.0054, 0.00562), (0.0052, 0.00538)),
    "rf": ((0.00549, 0.00978), (0.0052, 0.00489), (0.005, 0.00479)),
    "lfmetacarpal": ((0.00508, 0.00584, 0.01292), (0.00584, 0.005)),
    "lf": ((0.00529, 0.00816), (0.005, 0.00455), (0.0049, 0.00391)),
    "th": ((0.00736, 0.01027), (0.00638, 0.00697), (0.00618, 0.00587)),
}
"""Sizes of MIMo's five-finger hand, at which its parts have their masses: of the geoms of the palm, and of the bones of
each finger from its root."""
_BONES = {"knuckle": 0, "middle": 1, "distal": 2, "base": 0, "hub": 1}
"""The place of each bone in its finger, from the root."""

_PALM = ("hand_breadth", "hand_length")
_FINGER = ("hand_length", "middle_finger_diameter")
_THUMB = ("hand_length", "thumb_diameter")
_GRIP_CONDIM = 6  # Contacts of a hand also have torsional and rolling friction (MIMo).


def _palm(part: str, number: int, shape: GeomType, mass_kg: float, rule: str) -> ReferenceGeom:
    euler_deg = ALONG_X if shape == "cylinder" else UPRIGHT
    size_m = _SIZES_M[part][number - 1]
    name = f"{{side}}_{part}{number}"
    return ReferenceGeom(name, shape, mass_kg, _PALM, rule, euler_deg, condim=_GRIP_CONDIM, mass_at_m=size_m)


_FLEXORS = (-0.345, 1.0)  # Fingers close with more force than they open (MIMo).
_EVEN = (-1.0, 1.0)


def _motor(
    name: str, joint: str, gear_nm: float, force_range: tuple[float, float], vmax_lengths_per_s: float, driven: str
) -> ReferenceMotor:
    names = (f"act:{{side}}_{name}", f"robot:{{side}}_{joint}")
    return ReferenceMotor(*names, gear_nm, force_range, vmax_lengths_per_s, f"{{side}}_{driven}1")


def _finger_motors(name: str, gears_nm: Figures, vmax_lengths_per_s: Figures) -> Motors:
    """Return what moves a finger sideways, at its knuckle, and at its middle and distal joints."""
    bones = {"side": "knuckle", "knuckle": "knuckle", "middle": "middle", "distal": "distal"}
    return tuple(
        _motor(f"{name}_{joint}", f"{name}_{joint}", gear_nm, _EVEN if joint == "side" else _FLEXORS, vmax, name + bone)
        for (joint, bone), gear_nm, vmax in zip(bones.items(), gears_nm, vmax_lengths_per_s, strict=True)
    )


def _bone(name: str, mass_kg: float, size_from: tuple[str, str]) -> ReferenceGeom:
    rule = f"radius from {size_from[1]} / 2, length a share of half of hand_length"
    name, size_m = f"{{side}}_{name}1", _SIZES_M[name[:2]][_BONES[name[2:]]]
    return ReferenceGeom(name, "capsule", mass_kg, size_from, rule, condim=_GRIP_CONDIM, mass_at_m=size_m)


def _phalanx(
    name: str, parent: str, mass_kg: float, joints: Joints, size_from: tuple[str, str], motors: Motors
) -> ReferencePart:
    place = ("where the palm ends", _PALM) if name.endswith("knuckle") else ("where the one before it ends", _PALM[1:])
    return ReferencePart(
        f"{{side}}_{name}",
        f"{{side}}_{parent}",
        (_bone(name, mass_kg, size_from),),
        joints,
        position_from=place[1],
        rule=place[0],
        motors=motors,
        skin_spacing_m=0.002 if name.endswith("distal") else 0.004,
        torque_site=f"torque_{{side}}_{name[:2]}_{name[2:]}",
    )


def _hinge(
    name: str, axis: Vec3, range_deg: tuple[float, float], stiffness: float, damping: float, springref_deg: float = 0
) -> ReferenceJoint:
    return ReferenceJoint(f"robot:{{side}}_{name}", axis, range_deg, stiffness, damping, 0.0, 0.0001, springref_deg)


def _finger(
    name: str, parent: str, masses_kg: Figures, stiffness: Figures, motors: Motors
) -> tuple[ReferencePart, ReferencePart, ReferencePart]:
    """Return the three phalanges of a finger, the first of which also moves sideways."""
    side = _hinge(f"{name}_side", (0, 1, 0), (-25, 25), 0.003, 0.001)
    knuckle = _hinge(f"{name}_knuckle", (1, 0, 0), (-20, 90), stiffness[0], 0.0005, 45)
    middle = _hinge(f"{name}_middle", (1, 0, 0), (-5, 100), stiffness[1], 0.0005, 45)
    distal = _hinge(f"{name}_distal", (1, 0, 0), (-5, 80), stiffness[2], 0.0005, 30)
    return (
        _phalanx(f"{name}knuckle", parent, masses_kg[0], (side, knuckle), _FINGER, motors[:-2]),
        _phalanx(f"{name}middle", f"{name}knuckle", masses_kg[1], (middle,), _FINGER, motors[-2:-1]),
        _phalanx(f"{name}distal", f"{name}middle", masses_kg[2], (distal,), _FINGER, motors[-1:]),
    )


_FIRST = _finger_motors("ff", (0.05, 0.0619, 0.02063, 0.01548), (6.217, 4.368, 3.493, 2.539))
_MIDDLE = _finger_motors("mf", (0.05, 0.117, 0.039, 0.02925), (5.375, 4.325, 3.375, 2.577))
_RING = _finger_motors("rf", (0.05, 0.078, 0.026, 0.0195), (4.984, 2.817, 3.007, 2.313))
_LITTLE = _finger_motors("lf", (0.05, 0.0196, 0.00653, 0.00490), (5.282, 2.337, 2.566, 2.001))

_METACARPAL = ReferencePart(
    "{side}_lfmetacarpal",
    "{side}_hand",
    (
        _palm("lfmetacarpal", 1, "box", 0.002879, "the outer quarter of the palm"),
        _palm("lfmetacarpal", 2, "cylinder", 0.0009879, "rounds the metacarpal off at the knuckle"),
    ),
    (replace(_hinge("lf_meta", (0.571, 0, 0.821), (0, 40), 0.01, 0.001), left_axis=(-0.571, 0, 0.821)),),
    position_from=_PALM,
    rule="on the little finger's side of the palm",
    motors=(_LITTLE[0], _motor("lf_meta", "lf_meta", 0.064, _FLEXORS, 6.855, "lfmetacarpal")),
    skin_spacing_m=0.007,
    torque_site="torque_{side}_lf_meta",
)

_THUMB_BASE = ReferencePart(
    "{side}_thbase",
    "{side}_hand",
    (_bone("thbase", 0.005463, _THUMB),),
    (
        _hinge("th_swivel", (3, -5, -1), (-10, 110), 0.003, 0.001, 40),
        _hinge("th_adduction", (1, 2, 0), (-60, 0), 0.004, 0.001, -35),
    ),
    euler_deg=(0.0, 80.0, 30.0),
    position_from=_PALM,
    rule="on the first finger's side of the palm, near the wrist",
    motors=(
        _motor("thumb_side", "th_swivel", 0.373, _FLEXORS, 3.491, "thbase"),
        _motor("thumb_add", "th_adduction", 0.134, _EVEN, 5.646, "thbase"),
    ),
    skin_spacing_m=0.004,
    torque_site="torque_{side}_th_base",
)

HAND = (
    ReferencePart(
        "{side}_hand",
        "{side}_lower_arm",
        (
            _palm("hand", 1, "box", 0.01895, "three quarters of the palm, half of hand_length long"),
            _palm("hand", 2, "box", 0.003321, "widens the palm to hand_breadth near the wrist"),
            _palm("hand", 3, "cylinder", 0.003367, "rounds the palm off at the knuckles"),
            _palm("hand", 4, "cylinder", 0.004524, "rounds the palm off at the wrist, hand_breadth wide"),
        ),
        WRIST_JOINTS,
        position_from=WRIST,
        rule="palm's middle, a quarter of hand_length past the wrist",
        motors=WRIST_MOTORS,
        group="{side}_hand",
        skin_spacing_m=0.007,
        torque_site="torque_{side}_wrist",
    ),
    *_finger("ff", "hand", (0.002692, 0.001497, 0.001291), (0.0008, 0.0006, 0.0006), _FIRST),
    *_finger("mf", "hand", (0.003284, 0.001757, 0.001563), (0.0010, 0.0007, 0.0006), _MIDDLE),
    *_finger("rf", "hand", (0.002664, 0.001476, 0.001316), (0.0009, 0.0007, 0.0006), _RING),
    _METACARPAL,
    *_finger("lf", "lfmetacarpal", (0.002143, 0.001276, 0.001113), (0.0007, 0.0006, 0.0006), _LITTLE[1:]),
    _THUMB_BASE,
    _phalanx(
        "thhub",
        "thbase",
        0.003021,
        (
            _hinge("th_pivot", (1, 0, 0), (-10, 10), 0.002, 0.001),
            _hinge("th_middle", (0, -1, 0), (0, 90), 0.004, 0.001, 30),
        ),
        _THUMB,
        (
            _motor("thumb_pivot", "th_pivot", 0.1, _EVEN, 9.055, "thhub"),
            _motor("thumb_middle", "th_middle", 0.126, _FLEXORS, 3.877, "thhub"),
        ),
    ),
    _phalanx(
        "thdistal",
        "thhub",
        0.002509,
        (_hinge("th_distal", (0, -1, 0), (0, 90), 0.004, 0.001, 20),),
        _THUMB,
        (_motor("thumb_distal", "th_distal", 0.0945, _FLEXORS, 3.392, "thdistal"),),
    ),
)
"""Palm and fingers, in MIMo's order."""

MASSES_KG: Mapping[str, float] = {
    "lb": 1.1684,
    "cb": 1.3359,
    "ub1": 1.0976,
    "ub2": 0.9531,
    "ub3": 0.7279,
    "{side}_uarm1": 0.2708,
    "{side}_larm": 0.1869,
    "head": 1.7901,
    "{side}_eye1": 0.006329,
    "{side}_upper_leg1": 0.8067,
    "{side}_lower_leg1": 0.3370,
    "{side}_lower_leg2": 0.1170,
}
"""Masses of the parts that differ from those of the mitten body; the total is again 10.9 kg."""

EXCLUDED = (
    ("{side}_lower_arm", "{side}_thbase"),
    ("{side}_lower_arm", "{side}_lfmetacarpal"),
    ("{side}_thbase", "{side}_lfmetacarpal"),
)
"""Pairs of bodies without contacts: roots of thumb and little finger, and the forearm (by bit masks in MIMo)."""


FINGERS = {"ff": (0.95, 0.9), "mf": (1.0, 1.0), "rf": (0.95, 0.9), "lf": (0.91, 0.88)}
"""Radius and length of each finger relative to the middle finger (MIMo v2)."""


def fingers_dimensions(p: Proportions) -> BodyGeometry:
    """Return a five-finger hand, whose palm and middle finger are each half as long as the hand."""
    h = p.hand
    thick_m = 0.584 * h.half_thickness_m
    palm_m = h.length_m / 4 - thick_m
    wide = h.half_breadth_m / (REFERENCE_M["hand_breadth"] / 2)
    check_hand(h, h.half_breadth_m)
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
        dimensions |= finger_dimensions(name, root, girth * h.finger_radius_m, length * h.length_m / 8)
    return dimensions | _thumb_dimensions(h, palm_m, wide)


def _palm_dimensions(h: Hand, forearm: Limb, palm_m: float, thick_m: float, wide: float) -> BodyGeometry:
    middle_m = (0.0, 0.0, 0.0)
    side_x_m = 0.007 * wide
    meta_m = 0.204 * palm_m
    return BodyGeometry(
        origins={
            "{side}_hand": (side_x_m, -0.9 * h.half_thickness_m, forearm.length_m + palm_m + thick_m),
            "{side}_lfmetacarpal": (-0.01498 * wide, 0.0, 0.122 * palm_m),
        },
        shapes={
            "{side}_hand1": GeomShape((0.01712 * wide, thick_m, palm_m), middle_m),
            "{side}_hand2": GeomShape((0.00588 * wide, thick_m, palm_m / 2), (-h.half_breadth_m, 0.0, -palm_m / 2)),
            "{side}_hand3": GeomShape((thick_m, 0.01712 * wide - CLEARANCE_M), (0.0, 0.0, palm_m)),
            "{side}_hand4": GeomShape((thick_m, h.half_breadth_m), (-0.00588 * wide, 0.0, -palm_m)),
            "{side}_lfmetacarpal1": GeomShape((0.00508 * wide, thick_m, palm_m / 2), (-0.00883 * wide, 0.0, meta_m)),
            "{side}_lfmetacarpal2": GeomShape(
                (thick_m, 0.00508 * wide - CLEARANCE_M), (-0.00883 * wide, 0.0, meta_m + palm_m / 2)
            ),
        },
        anchors={
            "robot:{side}_hand1": (-side_x_m, 0.9 * thick_m, -0.68 * palm_m - thick_m),
            "robot:{side}_hand2": (-side_x_m, -0.6 * thick_m, -0.84 * palm_m - thick_m),
            "robot:{side}_hand3": (-side_x_m, 0.0, -palm_m - thick_m),
        },
    )


def finger_dimensions(name: str, root: Vec3, radius_m: float, half_m: float, tip: float = 0.45) -> BodyGeometry:
    """Return three phalanges, the first twice as long, from joint to joint, as each of the others.

    The first joint is at *root* in the part's frame, the first phalanx has half the length *half_m*; *tip* is by how
    much of its radius the last one's straight part is shorter than the second's.
    """
    tip_m = half_m / 2 - tip * radius_m
    return BodyGeometry(
        origins={
            f"{{side}}_{name}knuckle": root,
            f"{{side}}_{name}middle": (0.0, 0.0, 2 * half_m),
            f"{{side}}_{name}distal": (0.0, 0.0, half_m),
        },
        shapes={
            f"{{side}}_{name}knuckle1": GeomShape((radius_m, half_m), (0.0, 0.0, half_m)),
            f"{{side}}_{name}middle1": GeomShape((0.95 * radius_m, half_m / 2), (0.0, 0.0, half_m / 2)),
            f"{{side}}_{name}distal1": GeomShape((0.9025 * radius_m, tip_m), (0.0, 0.0, tip_m)),
        },
    )


def _thumb_dimensions(h: Hand, palm_m: float, wide: float) -> BodyGeometry:
    base_m, radius_m = 0.75 * h.length_m / 8, h.thumb_radius_m
    hub_m, tip_m = 0.75 * base_m, 0.6 * base_m
    return BodyGeometry(
        origins={
            "{side}_thbase": (0.0123 * wide, -0.423 * h.half_thickness_m, -0.633 * palm_m),
            "{side}_thhub": (0.0, 0.0, 2 * base_m),
            "{side}_thdistal": (0.0, 0.0, 2 * hub_m),
        },
        shapes={
            "{side}_thbase1": GeomShape((radius_m, base_m), (0.0, 0.0, base_m)),
            "{side}_thhub1": GeomShape((0.95 * radius_m, hub_m), (0.0, 0.0, hub_m)),
            "{side}_thdistal1": GeomShape((0.9025 * radius_m, tip_m), (0.0, 0.0, tip_m)),
        },
    )


FIVE_FINGER = PartKind(
    "five_finger",
    "Hands whose fingers move independently.",
    HAND,
    fingers_dimensions,
    replaces="hands",
    excluded=EXCLUDED,
    masses_kg=MASSES_KG,
)
