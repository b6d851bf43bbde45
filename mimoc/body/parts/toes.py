"""Feet with a separate big toe, of MIMo's second body: parts at 18 months, and their shapes."""

from dataclasses import replace

from mimoc.body.dimensions import Dimensions, Shape
from mimoc.body.part import ALONG_Y, LEG_LENGTH, LEG_SHARE, ReferenceGeom, ReferenceJoint, ReferenceMotor, ReferencePart
from mimoc.body.parts.leg import ANKLE_JOINTS, ANKLE_MOTORS
from mimoc.body.proportions import REFERENCE_M, Proportions
from mimoc.body.sections import CLEARANCE_M
from mimoc.errors import GeometryError
from mimoc.kinds import PartKind

_FOOT = ("foot_length", "foot_breadth")
_SOLE_GRIP = (2.0, 0.02, 0.01)

FOOT = (
    ReferencePart(
        "{side}_foot",
        "{side}_lower_leg",
        (
            ReferenceGeom("{side}_foot1", "cylinder", 0.03225, _FOOT, "heel, as wide as foot_breadth"),
            ReferenceGeom("{side}_foot2", "box", 0.04923, _FOOT, "sole, as wide as foot_breadth", friction=_SOLE_GRIP),
            ReferenceGeom(
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
        position_from=LEG_LENGTH,
        rule=LEG_SHARE,
        motors=ANKLE_MOTORS,
        matures_with="ankle",
        skin_spacing_m=0.015,
        torque_site="torque_{side}_ankle",
        runs_along_x=True,
    ),
)
"""The foot without its toes."""


def _toes(name: str, masses_kg: tuple[float, float], vmax_lengths_per_s: float) -> ReferencePart:
    box, tip = masses_kg
    names = f"act:{{side}}_{name}", f"robot:{{side}}_{name}"
    motor = ReferenceMotor(*names, 0.165, (-1.0, 0.3), vmax_lengths_per_s, f"{{side}}_{name}1")
    return ReferencePart(
        f"{{side}}_{name}",
        "{side}_foot",
        (
            ReferenceGeom(f"{{side}}_{name}1", "box", box, _FOOT, "a share of foot_breadth wide", friction=_SOLE_GRIP),
            ReferenceGeom(
                f"{{side}}_{name}2",
                "cylinder",
                tip,
                _FOOT,
                "rounds the toes off at foot_length from the heel",
                ALONG_Y,
                _SOLE_GRIP,
            ),
        ),
        (ReferenceJoint(f"robot:{{side}}_{name}", (0, -1, 0), (-60, 80), 0.053, 0.02, 0.002, 0.0001),),
        position_from=_FOOT,
        rule="at the ball of the foot",
        motors=(motor,),
        skin_spacing_m=0.010,
        torque_site=f"torque_{{side}}_{name}",
        runs_along_x=True,
    )


_BIG_TOE = _toes("big_toe", (0.004425, 0.003934), 1.774)
_OTHER_TOES = _toes("toes", (0.01006, 0.008612), 1.805)


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


KIND = PartKind("toes", "Feet with a separate big toe.", (*FOOT, _BIG_TOE, _OTHER_TOES), toes_dimensions)
LEFT = replace(KIND, parts=(*FOOT, _OTHER_TOES, _BIG_TOE))
"""MIMo lists the left toes in reverse order."""
