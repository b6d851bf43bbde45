"""Protective extension: an infant that tips over stretches its arms towards the floor."""

import math
from functools import partial

from mimoc.policies.reflexes.reflex import AgeWindow, Drives, Reflex, State
from mimoc.policies.reflexes.sensing import SIDES, Sensed

TIPPED = math.sin(math.radians(20))  # Tilt of the trunk from which on it acts, as the sine. Ours.
RATE_RAD_S = 0.7  # Speed of tipping over from which on it acts, 40 degrees a second. Ours.
POSTURE = 0.6  # Upward part of the trunk's axis over the last second: an infant that lies does not tip over.
HOLD_S = 1.0  # How long the arms stay stretched. Ours.
STRETCH, REACH, SPREAD, BEHIND = 0.9, 0.8, 0.5, 0.1
"""Drives of elbows and fingers, of shoulders towards the floor, and of what else the shoulders do: beside, and behind
the body, where little lifts the arms above the head. Ours."""

ONE, BOTH = {"since": 100.0}, {f"{side} since": 100.0 for side in SIDES}


def _arm(side: str, stretches, reach: str, other: str, spread: float) -> Drives:
    """Return the drives of one arm: the way that it reaches, another movement of the shoulder, and straight."""
    return {
        f"{side} {reach}": REACH * stretches,
        f"{side} {other}": spread * stretches,
        f"{side} elbow extension": STRETCH * stretches,
        f"{side} finger extension": STRETCH * stretches,
    }


def _since(sensed: Sensed, former, down, rate):
    """Return the time since an infant began to tip over one way, and how much that stretches the arms."""
    is_set_off = (down > TIPPED) & (rate > RATE_RAD_S) & (sensed.posture > POSTURE)
    since = sensed.xp.where(is_set_off, sensed.zero, former + sensed.step_s)
    return since, sensed.xp.where(since < HOLD_S, 1.0 + sensed.zero, sensed.zero)


def _fore_and_aft(sign: float, reach: str, spread: float, sensed: Sensed, state: State) -> tuple[Drives, State]:
    since, stretches = _since(sensed, state["since"], -sign * sensed.up[0], sign * sensed.rate_rad_s[1])
    drives: dict = {}
    for side in SIDES:
        drives |= _arm(side, stretches, reach, "shoulder abduction", spread)
    return drives, {"since": since}


forwards = partial(_fore_and_aft, 1.0, "arm forwards", SPREAD)  # Stretch both arms forwards when tipping forwards.
backwards = partial(_fore_and_aft, -1.0, "arm backwards", BEHIND)  # Stretch both arms backwards when tipping backwards.


def sideways(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Stretch the arm of the side that the infant tips over to."""
    drives, kept = {}, {}
    for side, left in (("right", -1.0), ("left", 1.0)):
        down, rate = -left * sensed.up[1], -left * sensed.rate_rad_s[0]
        kept[f"{side} since"], stretches = _since(sensed, state[f"{side} since"], down, rate)
        drives |= _arm(side, stretches, "shoulder abduction", "arm forwards", SPREAD)
    return drives, kept


REFLEXES = (
    Reflex(
        "protective_forwards",
        "tipping forwards from sitting",
        "arms stretch forwards, fingers open",
        AgeWindow(onset_months=(6, 9)),
        ("vestibular",),
        "memory; secondary sources say 4-6 months",
        forwards,
        ONE,
    ),
    Reflex(
        "protective_sideways",
        "tipping to a side from sitting",
        "the arm of that side stretches, fingers open",
        AgeWindow(onset_months=(6, 7)),
        ("vestibular",),
        "memory",
        sideways,
        BOTH,
    ),
    Reflex(
        "protective_backwards",
        "tipping backwards from sitting",
        "arms stretch backwards, fingers open",
        AgeWindow(onset_months=(8, 10)),
        ("vestibular",),
        "memory",
        backwards,
        ONE,
    ),
)
