"""Passive joints by age: stiffness, friction, damping, armature, rest angles and ranges.

A passive torque has to keep its proportion to gravity, which grows by volume x length; with constants, a newborn's neck
spring alone would hold up its head (D: no stiffness of infants' joints was measured). Hence, relative to 18 months,
stiffness and friction grow by v l, damping by v l^1.5 and armature by v l^2: v is the volume of the part that the joint
moves, l the standing height.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.body.maturing.maturity import Decay

POWERS: Mapping[str, float] = {
    "stiffness": 1.0,
    "frictionloss": 1.0,
    "damping": 1.5,
    "armature": 2.0,
}
"""Powers of the standing height that a joint's constants grow by, besides the volume of the part (D)."""

TONE = Decay(2.5, 1.5)
"""Flexor tone, shed over 2 to 4 months and gone by 6 (Amiel-Tison; Ballard 1991; M)."""

_FIST = {
    f"robot:{{side}}_{finger}_{joint}"
    for finger in ("ff", "mf", "rf", "lf")
    for joint in ("knuckle", "middle", "distal")
}
"""Joints that close five fingers to a fist."""

EXTRA_STIFFNESS: Mapping[str, float] = {
    "robot:{side}_hip1": 0.5,
    "robot:{side}_knee": 0.5,
    "robot:{side}_fingers": 0.5,
    "robot:{side}_elbow": 1.0,
    **dict.fromkeys(sorted(_FIST), 0.5),
}
"""How much stiffer newborns' joints are by their tone, relative to the law (D; arm recoil: Ballard 1991)."""

NEWBORN_REST_DEG: Mapping[str, float] = {
    "robot:{side}_hip1": -65.0,
    "robot:{side}_hip2": -30.0,
    "robot:{side}_knee": -90.0,
    "robot:{side}_elbow": -100.0,
    "robot:{side}_fingers": -100.0,
    "robot:{side}_foot1": 20.0,
    **{joint: 50.0 if joint.endswith("distal") else 65.0 for joint in sorted(_FIST)},
}
"""Angles at which newborns' springs are at rest: hips bent by 60 to 90 degrees, knees by 90, elbows by 90 to 110, fists
closed, ankles up (Amiel-Tison, Ballard; M); five fingers are bent as far in their ranges as a mitten's (D)."""


@dataclass(frozen=True, slots=True)
class Limit:
    """One end of a newborn's range of motion."""

    newborn_deg: float
    decay: Decay
    source: str
    """Publications, with what is known of them: S read in the source, M from memory, D derived."""


UPPER_LIMITS: Mapping[str, Limit] = {
    "robot:{side}_hip1": Limit(
        -32.0, Decay(12.0, 1.0), "Coon 1975 (S); Broughton 1993, Haas 1973, Forero 1989, Waugh 1983, Phelps 1985 (M)"
    ),
    "robot:{side}_knee": Limit(-21.4, Decay(5.5, 1.0), "Broughton 1993 (S)"),
    "robot:{side}_foot1": Limit(59.0, Decay(6.0, 1.0), "Waugh 1983 (M)"),
    "robot:{side}_elbow": Limit(-19.0, Decay(3.0, 1.0), "Shah (S)"),
}
LOWER_LIMITS: Mapping[str, Limit] = {
    "robot:{side}_foot1": Limit(-26.0, Decay(6.0, 1.0), "Waugh 1983 (M)"),
}
"""Newborns cannot straighten hips, knees and elbows; they bend their ankles further up, and less far down."""
