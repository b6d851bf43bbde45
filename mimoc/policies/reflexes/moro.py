"""Moro reflex: when the head drops back, or all of the body falls, the arms spread and then come back."""

from mimoc.base.units import GRAVITY_M_S2
from mimoc.policies.reflexes.reflex import AgeWindow, Drives, Reflex, State
from mimoc.policies.reflexes.sensing import SIDES, Sensed

DROP_RAD = 0.26  # Drop of the head that sets it off, 15 degrees; the examiner lets it drop by 20 to 30 degrees.
DROP_S = 0.5  # Time constant in which a drop is forgotten: slower turns do nothing.
DROPS, FALLS, FALL_S = 0.9, 0.4, 0.05
"""Specific force, as a share of gravity, below which a head that turns back drops instead of being moved, and below
which all of the body falls; and the time constant in which that is noticed. Ours."""
SPREAD_S, EMBRACE_S = 0.4, 1.5  # Length of the two phases; the literature has .3-.5 s and 1-2 s.
AGAIN_S = 3.0  # Time after which it can be set off again. Ours.
SPREAD, EMBRACE = 0.9, 0.4  # Drives of the two phases. Ours.

START = {"drop": 0.0, "fall": 0.0, "since": 100.0}


def moro(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Spread the arms, then let them come back and bend.

    The time since the stimulus runs through the phases:

        0 s             .4 s                      1.9 s          3 s
        | arms spread   | arms come back and bend | nothing      | can be set off again
    """
    xp, dt_s = sensed.xp, sensed.step_s
    x, y, z = sensed.head_force_m_s2
    force, one, keep = (x * x + y * y + z * z) / GRAVITY_M_S2**2, 1.0 + sensed.zero, sensed.keep(FALL_S)
    turn_back = xp.where(force < DROPS**2, -dt_s * sensed.head_rate_rad_s[1], sensed.zero)
    drop = sensed.keep(DROP_S) * state["drop"] + turn_back
    falls = xp.where(force < FALLS**2, one, sensed.zero)
    fall = keep * state["fall"] + (1.0 - keep) * falls
    is_set_off = ((drop > DROP_RAD) | (fall > 0.8)) & (state["since"] > AGAIN_S)
    since = xp.where(is_set_off, sensed.zero, state["since"] + dt_s)
    spreads = xp.where(since < SPREAD_S, one, sensed.zero)
    comes_back = xp.where((since >= SPREAD_S) & (since < SPREAD_S + EMBRACE_S), one, sensed.zero)
    drives = {}
    for side in SIDES:
        for movement in ("shoulder abduction", "elbow extension", "finger extension"):
            drives[f"{side} {movement}"] = SPREAD * spreads
        for movement in ("shoulder adduction", "arm forwards", "elbow flexion"):
            drives[f"{side} {movement}"] = EMBRACE * comes_back
    return drives, {"drop": drop, "fall": fall, "since": since}


REFLEXES = (
    Reflex(
        "moro",
        "the head drops back, or all of the body falls",
        "arms spread, elbows and fingers straighten (.3-.5 s), then arms come back and bend (1-2 s)",
        AgeWindow(loss_months=(4, 6)),
        ("vestibular",),
        "secondary sources; times from memory",
        moro,
        START,
    ),
)
