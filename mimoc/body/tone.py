"""Muscle tone: what a quiet infant's muscles do without a command, by joint and age.

Tone is a drive and no spring: it acts within the limits of a motor's strength, grows with arousal, and is gone when an
infant is slack. Of a quiet infant, its torque is

    tau = -k (q - q_0),    k = kappa W s M(age)

with the greatest weight moment W of what hangs on the joint at 18 months, the growth s of passive joints (see
`mimoc.body.joints`), and the newborn share M, 1 at birth. The angles q_0 lie beyond the posture that tone holds against
gravity, since a flexor does not resist flexion.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.body.maturation import FISTS, Decay
from mimoc.body.origins import AGE_KEY, LAW, LAW_KEY, LENGTH_KEY, Origin
from mimoc.body.tree import Motor, Tone

TONE = Decay(2.5, 1.5)  # Flexor tone, shed over 2 to 4 months and gone by 6 (Amiel-Tison; Ballard 1991; M).


@dataclass(frozen=True, slots=True)
class NewbornTone:
    """Tone at birth, for a body of the size of 18 months."""

    stiffness_nm_per_rad: float  # kappa W (D).
    angle_deg: float  # q_0 (D).


_FINGERS = {"ff": 0.006, "mf": 0.012, "rf": 0.008, "lf": 0.002}
"""k of the knuckles, by finger: by a radian, a tenth of their strength at 18 months, or 3 % of a newborn's (D). A hand
that is straightened is a fist again within 3 s; by half of MIMo's stiffness, it would take half a minute."""
_JOINTS = {"knuckle": (1.0, 65.0), "middle": (0.6, 65.0), "distal": (0.25, 50.0)}
"""k by that of the knuckle, as strength is, and q_0."""


def _fist(joint: str) -> NewbornTone:
    _, finger, place = joint.rsplit("_", 2)
    share, angle_deg = _JOINTS[place]
    return NewbornTone(share * _FINGERS[finger], angle_deg)


NEWBORN_TONE: Mapping[str, NewbornTone] = {
    "robot:{side}_hip1": NewbornTone(0.38 * 2.21, -130.0),
    "robot:{side}_hip2": NewbornTone(0.95 * 2.21, -30.0),
    "robot:{side}_hip3": NewbornTone(1.0 * 0.614, 40.0),
    "robot:{side}_knee": NewbornTone(2.5 * 0.648, -88.0),
    "robot:{side}_elbow": NewbornTone(2.5 * 0.215, -100.0),
    "robot:{side}_foot1": NewbornTone(0.5 * 1.29, 20.0),
    "robot:{side}_fingers": NewbornTone(0.5 * 0.017, -100.0),
    **{joint: _fist(joint) for joint in FISTS},
}
"""Chosen such that newborns rest with hips bent by 55 degrees, knees by 90 and elbows by 90, and kick by 50 degrees
with less than .8 of their strength (posture: Amiel-Tison, Ballard, M; k, q_0: D). Of ankles and mittens, k is half of
MIMo's stiffness of their joints."""

SOURCE = "posture of newborns: Amiel-Tison, Ballard, M; fitted to it, D"


def tone_of(joint: str, size: float, age_months: float) -> Tone | None:
    """Return the tone of a joint, named with `{side}`, of passive growth *size*; None if it has none yet."""
    newborn, share = NEWBORN_TONE.get(joint), TONE(age_months)
    if newborn is None or not share:
        return None
    return Tone(newborn.stiffness_nm_per_rad * size * share, newborn.angle_deg)


def tone_origin(motor: Motor) -> Origin:
    """Return where the muscle tone of a motor comes from."""
    if motor.tone is None:
        return Origin("no muscle tone at this joint and age", (AGE_KEY, LAW_KEY))
    rule = (
        f"muscle tone of a quiet infant by {LAW}, {motor.tone.stiffness_nm_per_rad:.6g} N m/rad towards "
        f"{motor.tone.angle_deg:g} degrees, within the strength of the motor ({SOURCE}; lost over 2 to 4 months, M)"
    )
    origin = Origin(rule, (LENGTH_KEY, AGE_KEY, LAW_KEY, "spec.actuation.arousal"))
    for key, factor in motor.tone.factors:
        origin = origin.times(f", of which {factor:.6g} is counted in ({key})", key)
    return origin
