"""Strength by age: how much of the strength that a motor has at 18 months an infant can use.

A motor's torque is that of MIMo at 18 months x v l r, and the load of its joint grows by v l: v is the volume of the
part that it moves and l the standing height, both relative to 18 months, and r the share of its muscle group's strength
that an infant of that age has. So r alone decides whether an infant can hold its own weight.

No dynamometry of infants exists. The curves were fitted to milestones (D): with them, compiled infants held up their
heads, reached, sat and stood at the ages at which children do (WHO Multicentre Growth Reference Study Group 2006;
Denver II, Frankenburg et al. 1992; Gerber, Wilks & Erdie-Lalena 2010). Those of hands are a guess (D).
"""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.body.maturing.maturity import Decay


@dataclass(frozen=True, slots=True)
class StrengthCurve:
    """The relative strength of a group of muscles by age."""

    newborn: float
    """At birth."""
    decay: Decay

    def __call__(self, age_months: float) -> float:
        """Return the strength relative to that at 18 months, beyond what size explains."""
        return 1 - (1 - self.newborn) * self.decay(age_months)


STRENGTH: Mapping[str, StrengthCurve] = {
    "neck": StrengthCurve(0.15, Decay(7.0, 1.5)),
    "neck_front": StrengthCurve(0.15, Decay(6.0, 1.7)),
    "trunk": StrengthCurve(0.15, Decay(4.4, 1.8)),
    "arm": StrengthCurve(0.12, Decay(13.0, 2.0)),
    "hand": StrengthCurve(0.40, Decay(10.0, 1.5)),
    "hip": StrengthCurve(0.30, Decay(11.0, 1.4)),
    "knee": StrengthCurve(0.15, Decay(15.0, 2.0)),
    "ankle": StrengthCurve(0.10, Decay(16.0, 2.2)),
    "eyes": StrengthCurve(1.0, Decay(1.0, 1.0)),
}
"""By group of muscles that mature together (`Part.matures_with`); `neck` is its back and sides."""

FORWARDS: Mapping[str, str] = {"act:head_tilt": "neck_front"}
"""Motors whose torque towards positive angles comes from another group: the chin goes to the chest."""

NECK = "neck"
"""The group whose load is the head, which is heavier by this law: its strength and its joints grow with the head."""
