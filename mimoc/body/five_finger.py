"""Five-finger hands and two-toed feet: their parts, joints and motors, from MIMo's second body.

Names with `{side}` stand for a right and a left part; values are those of the right side. Fingers are
ff, mf, rf and lf (first, middle, ring, little) and th (thumb), as in MIMo (Mattern et al. 2024).
"""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.body.anatomy import ANKLE_JOINTS, WRIST_JOINTS
from mimoc.body.figures import (
    ALONG_X,
    ALONG_Y,
    LEG_LENGTH,
    LEG_SHARE,
    WRIST,
    GeomFigures,
    GeomType,
    JointFigures,
    MotorFigures,
    Part,
)
from mimoc.body.motors import ANKLE_MOTORS, WRIST_MOTORS
from mimoc.geometry.rotations import Vec3

Figures = tuple[float, ...]

_SIZES_M: Mapping[str, Figures] = {
    "{side}_hand1": (0.01712, 0.00584, 0.02532),
    "{side}_hand2": (0.00588, 0.00584, 0.01292),
    "{side}_hand3": (0.00584, 0.0171),
    "{side}_hand4": (0.00584, 0.02298),
    "{side}_ffknuckle1": (0.00549, 0.00992),
    "{side}_ffmiddle1": (0.0052, 0.00501),
    "{side}_ffdistal1": (0.005, 0.00464),
    "{side}_mfknuckle1": (0.00579, 0.011),
    "{side}_mfmiddle1": (0.0054, 0.00562),
    "{side}_mfdistal1": (0.0052, 0.00538),
    "{side}_rfknuckle1": (0.00549, 0.00978),
    "{side}_rfmiddle1": (0.0052, 0.00489),
    "{side}_rfdistal1": (0.005, 0.00479),
    "{side}_lfmetacarpal1": (0.00508, 0.00584, 0.01292),
    "{side}_lfmetacarpal2": (0.00584, 0.005),
    "{side}_lfknuckle1": (0.00529, 0.00816),
    "{side}_lfmiddle1": (0.005, 0.00455),
    "{side}_lfdistal1": (0.0049, 0.00391),
    "{side}_thbase1": (0.00736, 0.01027),
    "{side}_thhub1": (0.00638, 0.00697),
    "{side}_thdistal1": (0.00618, 0.00587),
}
"""Sizes of MIMo's five-finger hand, at which its parts have their masses."""

_PALM = ("hand_breadth", "hand_length")
_FINGER = ("hand_length", "middle_finger_diameter")
_THUMB = ("hand_length", "thumb_diameter")
_FOOT = ("foot_length", "foot_breadth")
_SOLE_GRIP = (2.0, 0.02, 0.01)
_GRIP_CONDIM = 6
"""Contacts of a hand also have torsional and rolling friction (MIMo)."""


def _palm(number: int, shape: GeomType, mass_kg: float, rule: str) -> GeomFigures:
    euler_deg = ALONG_X if shape == "cylinder" else (0.0, 0.0, 0.0)
    name = f"{{side}}_hand{number}"
    return GeomFigures(name, shape, mass_kg, _PALM, rule, euler_deg, condim=_GRIP_CONDIM, mass_at_m=_SIZES_M[name])


_FLEXORS = (-0.345, 1.0)
"""Fingers close with more force than they open (MIMo)."""
_EVEN = (-1.0, 1.0)
_TOE_FORCE = (-1.0, 0.3)


def _motor(
    name: str, joint: str, gear_nm: float, force_range: tuple[float, float], vmax_lengths_per_s: float, mover: str
) -> MotorFigures:
    names = (f"act:{{side}}_{name}", f"robot:{{side}}_{joint}")
    return MotorFigures(*names, gear_nm, force_range, vmax_lengths_per_s, f"{{side}}_{mover}1")


def _finger_motors(name: str, gears_nm: Figures, vmax_lengths_per_s: Figures) -> tuple[MotorFigures, ...]:
    """Return what moves a finger sideways, at its knuckle, and at its middle and distal joints."""
    return tuple(
        _motor(f"{name}_{joint}", f"{name}_{joint}", gear_nm, force_range, vmax, f"{name}{mover}")
        for (joint, force_range, mover), gear_nm, vmax in zip(_FINGER_JOINTS, gears_nm, vmax_lengths_per_s, strict=True)
    )


_FINGER_JOINTS = (
    ("side", _EVEN, "knuckle"),
    ("knuckle", _FLEXORS, "knuckle"),
    ("middle", _FLEXORS, "middle"),
    ("distal", _FLEXORS, "distal"),
)
"""Joint, force range, and the phalanx whose size its strength follows."""


def _phalanx(
    name: str,
    parent: str,
    mass_kg: float,
    joints: tuple[JointFigures, ...],
    follows: tuple[str, ...],
    motors: tuple[MotorFigures, ...],
) -> Part:
    geom = GeomFigures(
        f"{{side}}_{name}1",
        "capsule",
        mass_kg,
        follows,
        f"radius from {follows[1]} / 2, length a share of half of hand_length",
        condim=_GRIP_CONDIM,
        mass_at_m=_SIZES_M[f"{{side}}_{name}1"],
    )
    place = ("where the palm ends", _PALM) if name.endswith("knuckle") else ("where the one before it ends", _PALM[1:])
    return Part(
        f"{{side}}_{name}",
        f"{{side}}_{parent}",
        (geom,),
        joints,
        follows=place[1],
        rule=place[0],
        motors=motors,
        skin_spacing_m=0.002 if name.endswith("distal") else 0.004,
        torque_site=f"torque_{{side}}_{name[:2]}_{name[2:]}",
    )


def _hinge(
    name: str, axis: Vec3, range_deg: tuple[float, float], stiffness: float, damping: float, springref_deg: float = 0
) -> JointFigures:
    return JointFigures(f"robot:{{side}}_{name}", axis, range_deg, stiffness, damping, 0.0, 0.0001, springref_deg)


def _finger(
    name: str, parent: str, masses_kg: Figures, stiffness: Figures, motors: tuple[MotorFigures, ...]
) -> tuple[Part, Part, Part]:
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

_METACARPAL = Part(
    "{side}_lfmetacarpal",
    "{side}_hand",
    (
        GeomFigures(
            "{side}_lfmetacarpal1",
            "box",
            0.002879,
            _PALM,
            "the outer quarter of the palm",
            condim=_GRIP_CONDIM,
            mass_at_m=_SIZES_M["{side}_lfmetacarpal1"],
        ),
        GeomFigures(
            "{side}_lfmetacarpal2",
            "cylinder",
            0.0009879,
            _PALM,
            "rounds the metacarpal off at the knuckle",
            ALONG_X,
            condim=_GRIP_CONDIM,
            mass_at_m=_SIZES_M["{side}_lfmetacarpal2"],
        ),
    ),
    (replace(_hinge("lf_meta", (0.571, 0, 0.821), (0, 40), 0.01, 0.001), left_axis=(-0.571, 0, 0.821)),),
    follows=_PALM,
    rule="on the little finger's side of the palm",
    motors=(_LITTLE[0], _motor("lf_meta", "lf_meta", 0.064, _FLEXORS, 6.855, "lfmetacarpal")),
    skin_spacing_m=0.007,
    torque_site="torque_{side}_lf_meta",
)

_THUMB_BASE = Part(
    "{side}_thbase",
    "{side}_hand",
    (
        GeomFigures(
            "{side}_thbase1",
            "capsule",
            0.005463,
            _THUMB,
            "radius from thumb_diameter / 2, length a share of half of hand_length",
            condim=_GRIP_CONDIM,
            mass_at_m=_SIZES_M["{side}_thbase1"],
        ),
    ),
    (
        _hinge("th_swivel", (3, -5, -1), (-10, 110), 0.003, 0.001, 40),
        _hinge("th_adduction", (1, 2, 0), (-60, 0), 0.004, 0.001, -35),
    ),
    euler_deg=(0.0, 80.0, 30.0),
    follows=_PALM,
    rule="on the first finger's side of the palm, near the wrist",
    motors=(
        _motor("thumb_side", "th_swivel", 0.373, _FLEXORS, 3.491, "thbase"),
        _motor("thumb_add", "th_adduction", 0.134, _EVEN, 5.646, "thbase"),
    ),
    skin_spacing_m=0.004,
    torque_site="torque_{side}_th_base",
)

HAND = (
    Part(
        "{side}_hand",
        "{side}_lower_arm",
        (
            _palm(1, "box", 0.01895, "three quarters of the palm, half of hand_length long"),
            _palm(2, "box", 0.003321, "widens the palm to hand_breadth near the wrist"),
            _palm(3, "cylinder", 0.003367, "rounds the palm off at the knuckles"),
            _palm(4, "cylinder", 0.004524, "rounds the palm off at the wrist, hand_breadth wide"),
        ),
        WRIST_JOINTS,
        follows=WRIST,
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

FOOT = (
    Part(
        "{side}_foot",
        "{side}_lower_leg",
        (
            GeomFigures("{side}_foot1", "cylinder", 0.03225, _FOOT, "heel, as wide as foot_breadth"),
            GeomFigures("{side}_foot2", "box", 0.04923, _FOOT, "sole, as wide as foot_breadth", friction=_SOLE_GRIP),
            GeomFigures(
                "{side}_foot3",
                "cylinder",
                0.01312,
                _FOOT,
                "ball of the foot, as wide as foot_breadth",
                ALONG_Y,
                _SOLE_GRIP,
            ),
        ),
        ANKLE_JOINTS,
        follows=LEG_LENGTH,
        rule=LEG_SHARE,
        motors=ANKLE_MOTORS,
        matures_with="ankle",
        skin_spacing_m=0.015,
        torque_site="torque_{side}_ankle",
        lies=True,
    ),
)
"""The foot without its toes."""


def _toes(name: str, masses_kg: tuple[float, float], vmax_lengths_per_s: float) -> Part:
    box, tip = masses_kg
    return Part(
        f"{{side}}_{name}",
        "{side}_foot",
        (
            GeomFigures(f"{{side}}_{name}1", "box", box, _FOOT, "a share of foot_breadth wide", friction=_SOLE_GRIP),
            GeomFigures(
                f"{{side}}_{name}2",
                "cylinder",
                tip,
                _FOOT,
                "rounds the toes off at foot_length from the heel",
                ALONG_Y,
                _SOLE_GRIP,
            ),
        ),
        (JointFigures(f"robot:{{side}}_{name}", (0, -1, 0), (-60, 80), 0.053, 0.02, 0.002, 0.0001),),
        follows=_FOOT,
        rule="at the ball of the foot",
        motors=(_motor(name, name, 0.165, _TOE_FORCE, vmax_lengths_per_s, name),),
        skin_spacing_m=0.010,
        torque_site=f"torque_{{side}}_{name}",
        lies=True,
    )


_BIG_TOE = _toes("big_toe", (0.004425, 0.003934), 1.774)
_OTHER_TOES = _toes("toes", (0.01006, 0.008612), 1.805)
TOES: Mapping[str, tuple[Part, ...]] = {"right": (_BIG_TOE, _OTHER_TOES), "left": (_OTHER_TOES, _BIG_TOE)}
"""The big toe and the other toes, which MIMo lists in reverse order on the left."""

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
