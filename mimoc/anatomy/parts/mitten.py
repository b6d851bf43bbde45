"""Mitten hands, whose fingers move together (Mattern et al. 2024): parts at 18 months, and their shapes."""

from mimoc.anatomy.dimensions import BodyGeometry, GeomShape
from mimoc.anatomy.part import ALONG_X, WRIST, PartKind, ReferenceGeom, ReferenceJoint, ReferenceMotor, ReferencePart
from mimoc.anatomy.parts.arm import WRIST_JOINTS, WRIST_MOTORS
from mimoc.anatomy.sections import CLEARANCE_M
from mimoc.anatomy.segments import Hand, Proportions
from mimoc.base.errors import GeometryError

_PALM = ("maximum_fist_breadth", "hand_length", "hand_breadth")
_FINGERS = ("hand_breadth", "hand_length")
_HAND_GRIP = (5.0, 0.02, 0.01)

HAND = (
    ReferencePart(
        "{side}_hand",
        "{side}_lower_arm",
        (
            ReferenceGeom(
                "{side}_hand1",
                "box",
                0.04315,
                _PALM,
                "as wide as maximum_fist_breadth, half of hand_length less the fingertip's radius",
            ),
            ReferenceGeom("{side}_hand2", "cylinder", 0.01602, _PALM, "rounds the palm off at the knuckles", ALONG_X),
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
                _FINGERS,
                "as wide as hand_breadth, half of hand_length less the fingertip's radius",
                friction=_HAND_GRIP,
            ),
            ReferenceGeom(
                "{side}_fingers2",
                "cylinder",
                0.01323,
                _FINGERS,
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


KIND = PartKind("mitten", "Hands whose fingers move together.", HAND, mitten_dimensions, replaces="hands")
