"""Ends of joints' ranges in MuJoCo: how soon they stop a joint, and how far before its end they begin to.

A limit is a spring with a damper, at its critical damping with a time constant tau: a joint that arrives at the speed w
goes w tau / e too far, and up to w h more with physics steps of h, because a limit acts from the first step on that
begins beyond it. MIMo's 20 ms let limbs that swing freely, of 25 to 40 rad/s, go 8 to 25 degrees too far. By the law
`maturing`, tau is 10 ms, or 2 h for steps longer than 5 ms, the shortest that MuJoCo admits: a single step then stops a
joint. Its limits act from

    m = min(max(0, w h - OVERSHOOT), range / 4),    h = 5 ms

before its end, such that with physics steps of 5 ms a joint no faster than w goes `OVERSHOOT` too far at most, if its
range is not small (D): 2 degrees of limbs, 8 of fingers and toes, and 0 of eyes. A slowly moved joint stops there, too;
so longer steps, which would need 12 degrees of limbs, have no more and overshoot further. What `margin` means to joints
is the same from MuJoCo 3.5 on.
"""

from mimoc.anatomy.part import Development, ReferenceJoint
from mimoc.base.units import rad_to_deg
from mimoc.body.origins import LAW, LAW_KEY, Origin
from mimoc.body.strength import FASTEST_RAD_S

PUBLISHED_TAU_S, TAU_S = 0.02, 0.01
IMPEDANCE = (0.98, 0.99, 0.001, 0.5, 1.0)
"""MIMo's `solimplimit`."""

LIGHT_RAD_S, EYES_RAD_S = 55.0, 13.5
"""Speed w of fingers and toes, which blows give them (D, random commands), and of eyes: torque by damping. Limbs have
that at which motors no longer pull."""
LIGHT_KGM2 = 5e-4
"""Largest armature of fingers and toes at 18 months (MIMo)."""
OVERSHOOT_DEG = 8.0
"""Goal of the largest overshoot (D); contacts and other joints add to it."""
STEP_S = 0.005
"""Physics step h for which joints stop in time."""
LARGEST_SHARE = 0.25
"""Largest margin, as a share of the range: half of a small range stays free (D)."""


def limits_of(development: Development) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Return the attributes in MJCF that all limits of a law of development have in common."""
    tau_s = PUBLISHED_TAU_S if development == "published" else TAU_S
    return ("solreflimit", (tau_s, 1.0)), ("solimplimit", IMPEDANCE)


def limit_margin(figures: ReferenceJoint, group: str, range_deg: tuple[float, float]) -> float:
    """Return how far before both ends of its range a joint's limits act by the law `maturing`, m, in [deg]."""
    low, high = range_deg
    return min(
        max(0.0, rad_to_deg(_speed_rad_s(figures, group) * STEP_S) - OVERSHOOT_DEG), LARGEST_SHARE * (high - low)
    )


def margin_origin(joint: str, figures: ReferenceJoint, group: str) -> Origin:
    """Return where the margin of a joint comes from, named with its side; the other arguments are `limit_margin`'s."""
    rule = (
        f"how far before both ends of its range limits act by {LAW}: {_speed_rad_s(figures, group):g} rad/s x "
        f"{1000 * STEP_S:g} ms - {OVERSHOOT_DEG:g} degrees that a joint so fast may still go too far, but no more than "
        f"{LARGEST_SHARE:g} x the range (D)"
    )
    return Origin(rule, (f"joint.{joint}.range", LAW_KEY))


def _speed_rad_s(figures: ReferenceJoint, group: str) -> float:
    limb_rad_s = LIGHT_RAD_S if figures.armature_kgm2 <= LIGHT_KGM2 else FASTEST_RAD_S
    return EYES_RAD_S if group == "eyes" else limb_rad_s
