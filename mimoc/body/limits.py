"""Ends of joints' ranges in MuJoCo: how soon they stop a joint, and how far before its end they begin to.

A limit is a spring with a damper, at its critical damping with a time constant tau: a joint that arrives at the speed w
goes w tau / e too far, and up to w h more with physics steps of h, because a limit acts from the first step on that
begins beyond it. MIMo's 20 ms let limbs that swing freely, of 25 to 40 rad/s, go 8 to 25 degrees too far. By the law
`maturing`, tau is 10 ms, or 2 h for steps longer than 5 ms, the shortest that MuJoCo admits: a single step then stops a
joint. Its limits act from

    m = min(max(0, w h - OVERSHOOT), range / 4),    h = 5 ms at most

before its end, such that with physics steps of 5 ms a joint no faster than w goes `OVERSHOOT` too far at most, if its
range is not small (D): 2 degrees of limbs, 8 of fingers and toes, and 0 of eyes. A slowly moved joint stops there, too;
so longer steps, which would need 12 degrees of limbs, have no more and overshoot further. What `margin` means to joints
is the same from MuJoCo 3.5 on.
"""

from mimoc.base.units import deg_to_rad
from mimoc.body.part import Development, ReferenceJoint
from mimoc.body.tree import Joint

PUBLISHED_TAU_S, TAU_S = 0.02, 0.01
IMPEDANCE = (0.98, 0.99, 0.001, 0.5, 1.0)
"""MIMo's `solimplimit`."""

LIMBS_RAD_S, LIGHT_RAD_S, EYES_RAD_S = 35.0, 55.0, 13.5
"""Speed w: at which motors no longer pull (`mimoc.body.strength.FASTEST_RAD_S`); what blows give fingers and toes (D,
random commands); and torque by damping of an eye."""
LIGHT_KGM2 = 5e-4
"""Largest armature of fingers and toes at 18 months (MIMo)."""
OVERSHOOT_DEG = 8.0
"""Goal of the largest overshoot (D); contacts and other joints add to it."""
LONGEST_STEP_S = 0.005
"""Longest physics step for which joints stop in time."""
LARGEST_SHARE = 0.25
"""Largest margin, as a share of the range: half of a small range stays free (D)."""


def limits_of(development: Development) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Return the attributes in MJCF that all limits of a law of development have in common."""
    tau_s = PUBLISHED_TAU_S if development == "published" else TAU_S
    return ("solreflimit", (tau_s, 1.0)), ("solimplimit", IMPEDANCE)


def stopped_speed(figures: ReferenceJoint, group: str) -> float:
    """Return the speed w of a joint by the law `maturing`, in [rad/s]; *group* is what its strength matures with."""
    if group == "eyes":
        return EYES_RAD_S
    return LIGHT_RAD_S if figures.armature_kgm2 <= LIGHT_KGM2 else LIMBS_RAD_S


def limit_margin(joint: Joint, timestep_s: float) -> float:
    """Return how far before both ends of a joint's range its limits act, m, in [rad]; 0 by the published law."""
    low, high = joint.range_deg
    early_rad = joint.stopped_rad_s * min(timestep_s, LONGEST_STEP_S) - deg_to_rad(OVERSHOOT_DEG)
    return min(max(0.0, early_rad), LARGEST_SHARE * deg_to_rad(high - low))
