"""Feet whose toes move together (Mattern et al. 2024), and feet with a separate big toe, of MIMo's second body.

Names with `{side}` stand for a right and a left part; values are those of the right side at 18 months.
"""

from dataclasses import replace

from mimoc.anatomy.dimensions import BodyGeometry, GeomShape
from mimoc.anatomy.part import (
    ALONG_Y,
    LEG_LENGTH,
    LEG_SHARE,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
)
from mimoc.anatomy.parts.leg import ANKLE_JOINTS, ANKLE_MOTORS
from mimoc.anatomy.sections import CLEARANCE_M
from mimoc.anatomy.segments import REFERENCE_M, Foot, Proportions
from mimoc.base.errors import GeometryError

_SOLE_GRIP = (2.0, 0.02, 0.01)
_SIZE = ("foot_breadth", "foot_length")
_WIDE = "as wide as foot_breadth"
_TIP_RULE = "rounds the toes off at foot_length from the heel"


def _foot(masses_kg: tuple[float, float, float], size_from: tuple[str, ...]) -> ReferencePart:
    """Return a foot without its toes: heel, sole and ball."""
    heel, sole, ball = (f"{{side}}_foot{number}" for number in (1, 2, 3))
    heel_kg, sole_kg, ball_kg = masses_kg
    return ReferencePart(
        "{side}_foot",
        "{side}_lower_leg",
        (
            ReferenceGeom(heel, "cylinder", heel_kg, size_from, f"heel, {_WIDE}"),
            ReferenceGeom(sole, "box", sole_kg, size_from, f"sole, {_WIDE}", friction=_SOLE_GRIP),
            ReferenceGeom(ball, "cylinder", ball_kg, size_from, f"ball of the foot, {_WIDE}", ALONG_Y, _SOLE_GRIP),
        ),
        ANKLE_JOINTS,
        position_from=LEG_LENGTH,
        rule=LEG_SHARE,
        motors=ANKLE_MOTORS,
        matures_with="ankle",
        skin_spacing_m=0.015,
        torque_site="torque_{side}_ankle",
        runs_along_x=True,
    )


TOES = ReferencePart(
    "{side}_toes",
    "{side}_foot",
    (
        ReferenceGeom("{side}_toes1", "box", 0.01084, _SIZE, f"toes, {_WIDE}", friction=_SOLE_GRIP),
        ReferenceGeom("{side}_toes2", "cylinder", 0.01226, _SIZE, _TIP_RULE, ALONG_Y, _SOLE_GRIP),
    ),
    (ReferenceJoint("robot:{side}_toes", (0, -1, 0), (-60, 80), 0.106, 0.04, 0.005, 0.0005),),
    position_from=_SIZE[::-1],
    rule="in proportion to the foot",
    motors=(ReferenceMotor("act:{side}_toes", "robot:{side}_toes", 0.33, (-1, 0.3), 1.29, "{side}_foot2"),),
    skin_spacing_m=0.010,
    torque_site="torque_{side}_toes",
    runs_along_x=True,
)


def _half_of_toes(name: str, masses_kg: tuple[float, float], vmax_lengths_per_s: float) -> ReferencePart:
    """Return the big toe or the others, half as stiff and strong as all of them."""
    box, tip, joint = f"{{side}}_{name}1", f"{{side}}_{name}2", f"robot:{{side}}_{name}"
    motor = ReferenceMotor(f"act:{{side}}_{name}", joint, 0.165, (-1.0, 0.3), vmax_lengths_per_s, box)
    return replace(
        TOES,
        name=f"{{side}}_{name}",
        geoms=(
            ReferenceGeom(box, "box", masses_kg[0], _SIZE[::-1], "a share of foot_breadth wide", friction=_SOLE_GRIP),
            ReferenceGeom(tip, "cylinder", masses_kg[1], _SIZE[::-1], _TIP_RULE, ALONG_Y, _SOLE_GRIP),
        ),
        joints=(ReferenceJoint(joint, (0, -1, 0), (-60, 80), 0.053, 0.02, 0.002, 0.0001),),
        rule="at the ball of the foot",
        motors=(motor,),
        torque_site=f"torque_{{side}}_{name}",
    )


def flat_foot_dimensions(p: Proportions) -> BodyGeometry:
    """Return heel, sole and toes, distributed along x so that the foot has its measured length."""
    f = p.foot
    s = _stretch(f, 0.084)
    sole = _foot_dimensions(f, -0.016 * s, (0.035 * s, 0.019 * s), 0.054 * s)
    toes = _toes_dimensions("toes", 0.007 * s, f.half_breadth_m, f.half_height_m)
    return sole | toes | BodyGeometry(origins={"{side}_toes": (0.054 * s, 0.0, 0.0)})


def two_toed_foot_dimensions(p: Proportions) -> BodyGeometry:
    """Return heel, sole, big toe and toes, distributed along x so that the foot has its measured length."""
    f = p.foot
    s, wide = _stretch(f, 0.079), f.half_breadth_m / (REFERENCE_M["foot_breadth"] / 2)
    return (
        _foot_dimensions(f, -0.007 * s, (0.030 * s, 0.023 * s), 0.053 * s)
        | _toes_dimensions("big_toe", 0.0095 * s, 0.0075 * wide, f.half_height_m)
        | _toes_dimensions("toes", 0.0095 * s, 0.0165 * wide, f.half_height_m)
        | BodyGeometry(
            {"{side}_big_toe": (0.053 * s, 0.0175 * wide, 0.0), "{side}_toes": (0.053 * s, -0.0075 * wide, 0.0)}
        )
    )


def _stretch(f: Foot, between_m: float) -> float:
    """Return by how much a foot, which may not be wider than long, is longer between its rounded ends than MIMo's."""
    if f.length_m <= 2 * f.half_breadth_m:
        raise GeometryError(f"a foot {f.length_m:.3f} m long cannot be {2 * f.half_breadth_m:.3f} m wide")
    heel_m = f.half_breadth_m - CLEARANCE_M
    return (f.length_m - heel_m - f.half_height_m) / between_m


def _foot_dimensions(f: Foot, heel_x_m: float, sole_m: tuple[float, float], ball_x_m: float) -> BodyGeometry:
    """Return heel, sole and ball from their places along x; *sole_m* is half its length, and its middle."""
    width_m, height_m, (half_m, sole_x_m) = f.half_breadth_m, f.half_height_m, sole_m
    return BodyGeometry(
        shapes={
            "{side}_foot1": GeomShape((width_m - CLEARANCE_M, height_m - CLEARANCE_M), (heel_x_m, 0.0, 0.0)),
            "{side}_foot2": GeomShape((half_m, width_m, height_m), (sole_x_m, 0.0, 0.0)),
            "{side}_foot3": GeomShape((height_m - CLEARANCE_M, width_m - 2 * CLEARANCE_M), (ball_x_m, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": (0.0, 0.0, 1.5 * height_m) for k in (1, 2, 3)},
    )


def _toes_dimensions(name: str, half_m: float, half_width_m: float, height_m: float) -> BodyGeometry:
    box_m = (half_m, half_width_m - CLEARANCE_M, height_m - CLEARANCE_M)
    return BodyGeometry(
        shapes={
            f"{{side}}_{name}1": GeomShape(box_m, (half_m, 0.0, 0.0)),
            f"{{side}}_{name}2": GeomShape((height_m, half_width_m), (2 * half_m, 0.0, 0.0)),
        }
    )


FLAT = PartKind(
    "flat_foot", "Toes move together.", (_foot((0.03219, 0.0585, 0.01268), _SIZE), TOES), flat_foot_dimensions
)
_TWO_TOED = _foot((0.03225, 0.04923, 0.01312), _SIZE[::-1])
_BIG_TOE = _half_of_toes("big_toe", (0.004425, 0.003934), 1.774)
_OTHER_TOES = _half_of_toes("toes", (0.01006, 0.008612), 1.805)
RIGHT_TWO_TOED = PartKind(
    "two_toed_foot", "The big toe moves by itself.", (_TWO_TOED, _BIG_TOE, _OTHER_TOES), two_toed_foot_dimensions
)
LEFT_TWO_TOED = replace(RIGHT_TWO_TOED, parts=(_TWO_TOED, _OTHER_TOES, _BIG_TOE))
"""MIMo lists the left toes in reverse order."""
